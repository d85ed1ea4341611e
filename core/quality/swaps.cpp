#include "core/quality/checks.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kWeakRatio = 0.6;  // where the other limbs change sides in the same frame
constexpr double kHasty = 2.5;      // m/s of the body's centre, faster than most people walk
constexpr double kTimes = 3.0;      // times the clip's usual speed
constexpr double kJitter = 0.05;    // metres that a tracker's noise moves it

/// Largest speed of the body's centre in one step of the clip, except across missing frames, m/s.
double FastestStep(const TrackedPoints& points, const std::vector<BodyCentre>& centres) {
  std::vector<double> speeds;
  for (int f = 1; f < points.frames(); ++f) {
    const BodyCentre &here = centres[static_cast<std::size_t>(f)], &before = centres[static_cast<std::size_t>(f) - 1];
    const double seconds = points.time_s[f] - points.time_s[f - 1];
    if (here.seen && before.seen && seconds > 0.0) speeds.push_back((here.place - before.place).norm() / seconds);
  }
  return std::max(kHasty, kTimes * Median(std::move(speeds)));
}

std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

/// Side (0 left, 1 right) and the name without it.
std::optional<std::pair<int, std::string>> SideOf(const std::string& name) {
  const std::string plain = Plain(name);
  for (const int side : {0, 1}) {
    const std::string word = side == 0 ? "left" : "right";
    if (const std::size_t at = plain.find(word); at != std::string::npos) {
      return std::pair(side, plain.substr(0, at) + plain.substr(at + word.size()));
    }
  }
  const std::size_t length = name.size();
  if (length > 2 && (name[length - 2] == '_' || name[length - 2] == '.')) {
    const char last = name[length - 1];
    if (last == 'l' || last == 'L') return std::pair(0, Plain(name.substr(0, length - 2)));
    if (last == 'r' || last == 'R') return std::pair(1, Plain(name.substr(0, length - 2)));
  }
  const char first = plain.empty() ? ' ' : plain[0];
  static const char* const kParts[] = {"hip",   "knee", "ankle", "foot",    "toe", "shoulder", "elbow",
                                       "wrist", "hand", "femur", "humerus", "tib", "clavicle", "radius"};
  for (const char* part : kParts) {
    if ((first == 'l' || first == 'r') && plain.compare(1, std::string(part).size(), part) == 0)
      return std::pair(first == 'l' ? 0 : 1, plain.substr(1));
  }
  return std::nullopt;
}

bool IsLeg(const std::string& part) {
  static const char* const kWords[] = {"hip", "knee", "ankle", "foot", "toe", "leg", "femur", "tib", "heel", "thigh"};
  return std::any_of(std::begin(kWords), std::end(kWords),
                     [&](const char* word) { return part.find(word) != std::string::npos; });
}

/// One kind of limb over the clip: in which frames the sides change.
struct Exchange {
  int frame = 0;  ///< first in the new state
  double ratio = 1.0;
};

/// One pair of limbs, and the squared steps with the sides as named and exchanged.
class LimbPair {
 public:
  LimbPair(const TrackedPoints& points, const std::vector<BodyCentre>& centres,
           const std::vector<std::array<int, 2>>& pairs, const SwapLimits& limits)
      : points_(points), centres_(centres), pairs_(pairs), limits_(limits), fastest_(FastestStep(points, centres)) {}

  /// `also`: frames in which weaker evidence is enough.
  std::vector<Exchange> Exchanges(const std::set<int>& also) const {
    std::vector<Exchange> exchanges;
    if (pairs_.size() < 2) return exchanges;   // one pair alone crosses in a clap
    std::vector<int> last(pairs_.size(), -1);  // last frame of each pair; a repeated frame counts as its first
    for (int f = 0; f < points_.frames(); ++f) {
      Costs costs;
      bool jumps = false;
      for (std::size_t i = 0; i < pairs_.size(); ++i) {
        if (!Seen(f, pairs_[i]) || (last[i] >= 0 && Repeats(f, last[i], pairs_[i]))) continue;
        const int before = last[i];
        last[i] = f;
        if (before < 0 || points_.time_s[f] - points_.time_s[before] > limits_.gap_s) continue;
        Add(f, before, pairs_[i], costs);
        jumps = jumps || Jumps(f, before);
      }
      if (jumps) continue;
      const double ratio = also.count(f) != 0 ? std::max(limits_.ratio, kWeakRatio) : limits_.ratio;
      if (!costs.IsDecisive(costs.straight, limits_.step) || costs.crossed >= ratio * costs.straight) continue;
      exchanges.push_back({f, costs.crossed / costs.straight});
      for (std::size_t i = 0; i < pairs_.size(); ++i) {
        if (!Seen(f, pairs_[i])) last[i] = -1;  // of the old state
      }
    }
    return WithLost(exchanges);
  }

 private:
  struct Costs {
    double straight = 0.0, crossed = 0.0;  ///< squared metres
    std::size_t compared = 0;              ///< pairs
    bool IsDecisive(double larger, double step) const {
      return compared >= 2 && std::sqrt(larger / (2.0 * static_cast<double>(compared))) > step;
    }
  };

  bool Seen(int f, const std::array<int, 2>& pair) const {
    return centres_[static_cast<std::size_t>(f)].seen && points_.sees(f, pair[0]) && points_.sees(f, pair[1]);
  }
  Vector3d At(int f, int k) const { return points_.at(f, k) - centres_[static_cast<std::size_t>(f)].place; }
  bool Repeats(int f, int before, const std::array<int, 2>& pair) const {
    return points_.at(f, pair[0]) == points_.at(before, pair[0]) &&
           points_.at(f, pair[1]) == points_.at(before, pair[1]);
  }
  void Add(int f, int before, const std::array<int, 2>& pair, Costs& costs) const {
    const auto& [left, right] = pair;
    costs.straight += (At(f, left) - At(before, left)).squaredNorm() + (At(f, right) - At(before, right)).squaredNorm();
    costs.crossed += (At(f, left) - At(before, right)).squaredNorm() + (At(f, right) - At(before, left)).squaredNorm();
    ++costs.compared;
  }

  /// Whether the body itself is elsewhere: frames are missing, and half a stride looks like an exchange of the legs.
  bool Jumps(int f, int before) const {
    const Vector3d step =
        centres_[static_cast<std::size_t>(f)].place - centres_[static_cast<std::size_t>(before)].place;
    return step.norm() > fastest_ * (points_.time_s[f] - points_.time_s[before]) + kJitter;
  }

  /// Whether frames a and b, near in time, clearly have the same sides.
  bool Alike(int a, int b) const {
    if (std::abs(points_.time_s[a] - points_.time_s[b]) > limits_.gap_s) return false;
    Costs costs;
    for (const auto& pair : pairs_) {
      if (Seen(a, pair) && Seen(b, pair)) Add(a, b, pair, costs);
    }
    return costs.IsDecisive(costs.crossed, limits_.step) && costs.straight < limits_.ratio * costs.crossed;
  }

  /// Adds exchanges without a single clear step, because limbs are missing or outliers there: shortly after an exchange
  /// the limbs are again as in the frame before it, or were before it as after it.
  std::vector<Exchange> WithLost(const std::vector<Exchange>& exchanges) const {
    std::vector<Exchange> all;
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
      const int f = exchanges[i].frame;
      const int first = i == 0 ? 0 : exchanges[i - 1].frame;
      const int end = i + 1 == exchanges.size() ? points_.frames() : exchanges[i + 1].frame;
      const bool found_before = !all.empty() && all.back().frame > first;
      for (int g = f - 2; g >= first && !found_before; --g) {
        if (!Alike(g, f)) continue;
        all.push_back({g + 1, exchanges[i].ratio});
        break;
      }
      all.push_back(exchanges[i]);
      for (int g = f + 1; g < end; ++g) {
        if (!Alike(g, f - 1)) continue;
        all.push_back({g, exchanges[i].ratio});
        break;
      }
    }
    return all;
  }

  const TrackedPoints& points_;
  const std::vector<BodyCentre>& centres_;
  const std::vector<std::array<int, 2>>& pairs_;
  const SwapLimits& limits_;
  const double fastest_;  ///< m/s
};

struct Span {
  int begin = 0, end = 0;
  double ratio = 1.0;
};

/// The spans of the rarer of the two states.
std::vector<Span> Rarer(const std::vector<Exchange>& exchanges, int frames) {
  std::vector<Span> states[2];
  Span span{0, 0, 1.0};
  int state = 0;
  for (const Exchange& exchange : exchanges) {
    span.end = exchange.frame;
    span.ratio = std::min(span.ratio, exchange.ratio);
    states[state].push_back(span);
    state = 1 - state;
    span = {exchange.frame, 0, exchange.ratio};
  }
  span.end = frames;
  states[state].push_back(span);
  int lasts[2] = {0, 0};
  for (const int i : {0, 1}) {
    for (const Span& part : states[i]) lasts[i] += part.end - part.begin;
  }
  return lasts[1] > lasts[0] ? states[0] : states[1];
}

}  // namespace

LimbPairs FindLimbPairs(const std::vector<std::string>& names) {
  std::map<std::string, std::array<int, 2>> parts;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto side = SideOf(names[k]);
    if (!side) continue;
    auto part = parts.emplace(side->second, std::array<int, 2>{-1, -1}).first;
    part->second[static_cast<std::size_t>(side->first)] = static_cast<int>(k);
  }
  LimbPairs pairs;
  for (const auto& [part, pair] : parts) {
    if (pair[0] < 0 || pair[1] < 0) continue;
    const bool face = part.find("eye") != std::string::npos || part.find("ear") == 0;
    (face ? pairs.face : IsLeg(part) ? pairs.legs : pairs.arms).push_back(pair);
  }
  return pairs;
}

std::vector<Finding> FindSwaps(const TrackedPoints& points, const SwapLimits& limits) {
  std::vector<Finding> findings;
  if (points.names.empty()) return findings;
  const LimbPairs pairs = FindLimbPairs(points.names);
  const std::vector<BodyCentre> centres = BodyCentres(points);
  std::map<std::pair<int, int>, std::pair<double, std::string>> spans;
  std::set<int> frames_of[2];
  for (const bool legs : {false, true}) {
    const LimbPair limbs(points, centres, legs ? pairs.legs : pairs.arms, limits);
    for (const Exchange& exchange : limbs.Exchanges({})) frames_of[legs ? 1 : 0].insert(exchange.frame);
  }
  for (const bool legs : {false, true}) {
    const auto exchanges =
        LimbPair(points, centres, legs ? pairs.legs : pairs.arms, limits).Exchanges(frames_of[legs ? 0 : 1]);
    if (exchanges.empty()) continue;
    for (const Span& span : Rarer(exchanges, points.frames())) {
      auto& [ratio, limbs] = spans.emplace(std::pair(span.begin, span.end), std::pair(1.0, "")).first->second;
      ratio = std::min(ratio, span.ratio);
      limbs += (limbs.empty() ? "" : " and ") + std::string(legs ? "legs" : "arms");
    }
  }
  for (const auto& [span, found] : spans) {
    findings.push_back(FrameFinding("swapped_sides", span.first, span.second, "", found.first,
                                    "left and right " + found.second + " are exchanged for " +
                                        Counted(span.second - span.first, "frame") +
                                        ": within a frame each moves to the other's position (squared steps are " +
                                        Digits(found.first) + " of those without the exchange)"));
  }
  return findings;
}

}  // namespace mocurate
