#include "core/quality/checks.h"

#include <algorithm>
#include <map>
#include <optional>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostStays = 1000;  // predecessors searched, for data that is not a motion
constexpr int kPaceFrames = 8;            // on either side of a frame
constexpr double kApart = 1.2;            // metres between the middles of two parts of a body

/// Consecutive frames [begin, end] (except frames without valid samples) with possible steps.
struct Stay {
  int begin = 0;
  int end = 0;     ///< last frame
  int frames = 0;  ///< in which the person is observed
  int best = 0;    ///< frames of the longest chain that ends here
  int before = -1;
};

class JumpPath {
 public:
  JumpPath(const TrackedPoints& points, const PositionJumpLimits& limits)
      : points_(points), limits_(limits), centres_(BodyCentres(points)) {
    FindSeenSets();
    FindMotionlessRuns();
    FindPace();
    Split();
    Chain();
  }

  std::vector<Finding> Teleports() const {
    std::vector<Finding> findings;
    int before = -1;
    std::size_t next = 0;
    for (std::size_t i = 0; i < stays_.size(); ++i) {
      const Stay& stay = stays_[i];
      if (home_[i]) {
        before = stay.end;
        continue;
      }
      for (next = std::max(next, i); next < stays_.size() && !home_[next];) ++next;
      const int after = next < stays_.size() ? stays_[next].begin : -1;
      if (before < 0 && after >= 0 && InTime(stay.end, after)) {
        findings.push_back(Jump(stay.end, after));
      } else if (before >= 0 && after < 0 && InTime(before, stay.begin)) {
        findings.push_back(Jump(before, stay.begin));
      } else {
        findings.push_back(Away(stay, before, after));
      }
    }
    return findings;
  }

  bool Seen(int f) const { return centres_[static_cast<std::size_t>(f)].seen; }
  const Vector3d& Place(int f) const { return centres_[static_cast<std::size_t>(f)].place; }

 private:
  Finding Away(const Stay& stay, int before, int after) const {
    double farthest = 0.0;
    for (int f = stay.begin; f <= stay.end; ++f) {
      if (Seen(f)) farthest = std::max(farthest, FromHome(f, before, after));
    }
    return FrameFinding("position_jump", stay.begin, stay.end + 1, "", farthest,
                        "for " + Counted(stay.end - stay.begin + 1, "frame") + " the person is " + Digits(farthest) +
                            " m from its place in the rest of the clip; a person moves at most at " +
                            Digits(limits_.speed) + " m/s, and accelerates by at most " + Digits(limits_.start) +
                            " m/s2");
  }

  Finding Jump(int from, int to) const {
    const double way = Way(from, to).stableNorm();
    return FrameFinding("unrecovered_jump", from, to + 1, "", way,
                        "the person moves " + Digits(way) + " m within " + Digits(1e3 * (Time(to) - Time(from))) +
                            " ms and not back: a person accelerates by at most " + Digits(limits_.start) +
                            " m/s2, so that the position on one side of this step is wrong");
  }

  double Time(int f) const { return points_.time_s[static_cast<std::size_t>(f)]; }
  double Pace(int from, int to) const {
    return std::max(pace_[static_cast<std::size_t>(from)], pace_[static_cast<std::size_t>(to)]);
  }

  /// At the top speed.
  bool InTime(int from, int to) const {
    const double reach = limits_.slack + limits_.speed * (Time(to) - Time(from));
    return Way(from, to).stableNorm() <= reach + limits_.lost_frames * Pace(from, to);
  }

  bool Possible(int from, int to) const {
    if (!InTime(from, to)) return false;
    const int since = repeated_since_[static_cast<std::size_t>(from)];
    const double passed = Time(to) - Time(since);
    const double started =
        limits_.sudden + limits_.start * passed * passed + (to - since + limits_.lost_frames) * Pace(from, to);
    return Way(from, to).stableNorm() <= started || MostGo(from, to) <= started;
  }

  /// Lower quartile in metres of the steps of points observed in both frames: exchanged sides move limbs, not the
  /// trunk.
  double MostGo(int from, int to) const {
    std::vector<double> ways;
    for (int k = 0; k < points_.count(); ++k) {
      if (points_.sees(from, k) && points_.sees(to, k))
        ways.push_back((points_.at(to, k) - points_.at(from, k)).stableNorm());
    }
    if (ways.empty()) return 0.0;
    const auto quarter = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() / 4);
    std::nth_element(ways.begin(), quarter, ways.end());
    return *quarter;
  }

  /// Between frames with the same observed points the difference of the centres, else the step of the common points.
  /// Centres of different points (legs, head) are not comparable.
  Vector3d Way(int from, int to) const {
    const Vector3d way = Place(to) - Place(from);
    if (seen_set_[static_cast<std::size_t>(from)] == seen_set_[static_cast<std::size_t>(to)]) return way;
    if (const auto step = BodyStep(points_, from, to)) return *step;
    return std::max(0.0, 1.0 - kApart / way.stableNorm()) * way;
  }

  void FindSeenSets() {
    std::map<std::vector<bool>, int> sets;
    for (int f = 0; f < points_.frames(); ++f) {
      std::vector<bool> seen(static_cast<std::size_t>(points_.count()));
      for (int k = 0; k < points_.count(); ++k) seen[static_cast<std::size_t>(k)] = points_.sees(f, k);
      seen_set_.push_back(sets.emplace(std::move(seen), static_cast<int>(sets.size())).first->second);
    }
  }

  void FindMotionlessRuns() {
    for (int f = 0; f < points_.frames(); ++f) {
      const bool repeated = f > 0 && Seen(f - 1) && Seen(f) && Place(f - 1) == Place(f);
      repeated_since_.push_back(repeated ? repeated_since_.back() : f);
    }
  }

  /// Metres per frame around each frame: the median step of moving points, or half of that over two frames if this is
  /// less, as for two alternating people.
  void FindPace() {
    const std::vector<std::optional<double>> ones = Steps(1), twos = Steps(2);
    for (int f = 0; f < points_.frames(); ++f) {
      const int begin = std::max(0, f - kPaceFrames), end = f + kPaceFrames;
      pace_.push_back(std::min(MiddleStep(ones, begin, end), 0.5 * MiddleStep(twos, begin, end)));
    }
  }

  /// From each frame to that `frames` later, metres; empty where either has no valid samples.
  std::vector<std::optional<double>> Steps(int frames) const {
    std::vector<std::optional<double>> steps;
    for (int f = 0; f + frames < points_.frames(); ++f) {
      const bool seen = Seen(f) && Seen(f + frames);
      steps.push_back(seen ? std::optional<double>(Way(f, f + frames).stableNorm()) : std::nullopt);
    }
    return steps;
  }

  static double MiddleStep(const std::vector<std::optional<double>>& steps, int begin, int end) {
    std::vector<double> there;
    for (int f = begin; f < std::min(end, static_cast<int>(steps.size())); ++f) {
      const auto& step = steps[static_cast<std::size_t>(f)];
      if (step && *step > 0.0) there.push_back(*step);
    }
    return Median(std::move(there));
  }

  void Split() {
    for (int f = 0; f < points_.frames(); ++f) {
      if (!Seen(f)) continue;
      if (stays_.empty() || !Possible(stays_.back().end, f)) stays_.push_back({f, f, 0, 0, -1});
      stays_.back().end = f;
      ++stays_.back().frames;
    }
  }

  /// The longest chain of stays, each reachable from the one before; the earlier of two equals.
  void Chain() {
    int last = -1;
    for (std::size_t i = 0; i < stays_.size(); ++i) {
      stays_[i].best = stays_[i].frames;
      for (std::size_t k = i > kMostStays ? i - kMostStays : 0; k < i; ++k) {
        const int length = stays_[k].best + stays_[i].frames;
        if (length <= stays_[i].best || !Possible(stays_[k].end, stays_[i].begin)) continue;
        stays_[i].best = length;
        stays_[i].before = static_cast<int>(k);
      }
      if (last < 0 || stays_[i].best > stays_[static_cast<std::size_t>(last)].best) last = static_cast<int>(i);
    }
    home_.assign(stays_.size(), false);
    for (; last >= 0; last = stays_[static_cast<std::size_t>(last)].before)
      home_[static_cast<std::size_t>(last)] = true;
  }

  /// From the straight line between the last frame at home before and the first after, each -1 without one.
  double FromHome(int f, int before, int after) const {
    if (before < 0 || after < 0) return Way(before < 0 ? after : before, f).stableNorm();
    const double share = (Time(f) - Time(before)) / (Time(after) - Time(before));
    return ((1.0 - share) * Way(before, f) + share * Way(after, f)).stableNorm();
  }

  const TrackedPoints& points_;
  const PositionJumpLimits& limits_;
  std::vector<BodyCentre> centres_;
  std::vector<int> seen_set_;  ///< (frames) equal where the same points are observed
  /// (frames) first frame of the motionless run that ends here: a stream that hung catches up afterwards.
  std::vector<int> repeated_since_;
  std::vector<double> pace_;  ///< (frames) metres per frame
  std::vector<Stay> stays_;
  std::vector<char> home_;
};

}  // namespace

std::vector<Finding> FindPositionJumps(const TrackedPoints& points, const PositionJumpLimits& limits) {
  const JumpPath path(points, limits);
  std::vector<Finding> findings = path.Teleports();
  for (int k = 0; k < points.count(); ++k) {
    for (int f = 0; f < points.frames(); ++f) {
      const int begin = f;
      double farthest = 0.0;
      for (; f < points.frames() && path.Seen(f) && points.sees(f, k); ++f) {
        const double distance = (points.at(f, k) - path.Place(f)).stableNorm();
        if (distance <= limits.reach) break;
        farthest = std::max(farthest, distance);
      }
      if (f == begin) continue;
      findings.push_back(FrameFinding("joint_far", begin, f, points.name(k), farthest,
                                      "'" + points.name(k) + "' is " + Digits(farthest) +
                                          " m from the middle of the body in " + Counted(f - begin, "frame")));
    }
  }
  return findings;
}

}  // namespace mocurate
