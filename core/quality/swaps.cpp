#include "core/quality/swaps.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace mocurate {
namespace {

constexpr double kWeakRatio = 0.6;  // where the other limbs change sides in the same frame

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

/// `also`: frames in which a weaker sign is enough.
std::vector<Exchange> Exchanges(const TrackedPoints& points, const std::vector<BodyCentre>& centres,
                                const std::vector<std::array<int, 2>>& pairs, const SwapLimits& limits,
                                const std::set<int>& also) {
  std::vector<Exchange> exchanges;
  if (pairs.size() < 2) return exchanges;  // one pair alone crosses in any clap
  const auto seen = [&](int f, const std::array<int, 2>& pair) {
    return centres[static_cast<std::size_t>(f)].seen && points.sees(f, pair[0]) && points.sees(f, pair[1]);
  };
  const auto at = [&](int f, int k) -> Vector3d {
    return points.at(f, k) - centres[static_cast<std::size_t>(f)].place;
  };
  const auto repeats = [&](int f, int before, const std::array<int, 2>& pair) {
    return points.at(f, pair[0]) == points.at(before, pair[0]) && points.at(f, pair[1]) == points.at(before, pair[1]);
  };
  std::vector<int> last(pairs.size(), -1);  // where each pair was last seen; a repeated frame is as old as its first
  for (int f = 0; f < points.frames(); ++f) {
    double straight = 0.0, crossed = 0.0;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto& [left, right] = pairs[i];
      if (!seen(f, pairs[i]) || (last[i] >= 0 && repeats(f, last[i], pairs[i]))) continue;
      const int before = last[i];
      last[i] = f;
      if (before < 0 || points.time_s[f] - points.time_s[before] > limits.gap_s) continue;
      straight += (at(f, left) - at(before, left)).squaredNorm() + (at(f, right) - at(before, right)).squaredNorm();
      crossed += (at(f, left) - at(before, right)).squaredNorm() + (at(f, right) - at(before, left)).squaredNorm();
      ++compared;
    }
    if (compared < 2) continue;
    const double rms = std::sqrt(straight / (2.0 * static_cast<double>(compared)));
    const double ratio = also.count(f) != 0 ? std::max(limits.ratio, kWeakRatio) : limits.ratio;
    if (rms <= limits.step || crossed >= ratio * straight) continue;
    exchanges.push_back({f, crossed / straight});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!seen(f, pairs[i])) last[i] = -1;  // of the old state
    }
  }
  return exchanges;
}

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
    if (!face) (IsLeg(part) ? pairs.legs : pairs.arms).push_back(pair);
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
    for (const Exchange& exchange : Exchanges(points, centres, legs ? pairs.legs : pairs.arms, limits, {}))
      frames_of[legs ? 1 : 0].insert(exchange.frame);
  }
  for (const bool legs : {false, true}) {
    const auto exchanges = Exchanges(points, centres, legs ? pairs.legs : pairs.arms, limits, frames_of[legs ? 0 : 1]);
    if (exchanges.empty()) continue;
    for (const Span& span : Rarer(exchanges, points.frames())) {
      auto& [ratio, limbs] = spans.emplace(std::pair(span.begin, span.end), std::pair(1.0, "")).first->second;
      ratio = std::min(ratio, span.ratio);
      limbs += (limbs.empty() ? "" : " and ") + std::string(legs ? "legs" : "arms");
    }
  }
  for (const auto& [span, found] : spans) {
    const int frames = span.second - span.first;
    findings.push_back(FrameFinding("swapped_sides", span.first, span.second, "", found.first,
                                    "left and right " + found.second + " are exchanged for " + std::to_string(frames) +
                                        (frames == 1 ? " frame" : " frames") +
                                        ": within a frame each goes to where the other was"));
  }
  return findings;
}

}  // namespace mocurate
