#include "core/quality/checks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kAbrupt = 1e-3;     // metres: intended holds end more softly, and sensor noise is larger
constexpr double kByChance = 0.01;   // expected holds by chance in a clip on a grid, above which a hold is not a defect
constexpr int kBeyondOthers = 3;     // times the longest hold of any moving joint: longer holds are not by chance
constexpr int kMostTimes = 4;        // copies of a frame: 15 Hz in a file of 60
constexpr double kNearlyAll = 0.9;   // of the frames
constexpr int kFewestRepeated = 5;   // different frames
constexpr double kCollapsed = 0.02;  // metres: smaller than any body

/// Calls with every step of a point between frames on end, as lengths along the axes.
template <typename Call>
void ForSteps(const TrackedPoints& points, int k, int begin, int end, const Call& call) {
  for (int f = std::max(1, begin); f < std::min(end, points.frames()); ++f) {
    if (!points.sees(f, k) || !points.sees(f - 1, k)) continue;
    call(Vector3d((points.at(f, k) - points.at(f - 1, k)).cwiseAbs()));
  }
}

/// The steps of a grid that all samples of a clip lie on, in its unit: pixels, or millimetres that were rounded.
/// Infinite along an axis in which nothing moves. Nothing where samples lie on no grid.
std::optional<Vector3d> GridOf(const TrackedPoints& points) {
  constexpr double kOff = 0.01;  // of a grid step: of numbers in single precision
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Vector3d grid(kNone, kNone, kNone);
  for (int k = 0; k < points.count(); ++k) {
    ForSteps(points, k, 0, points.frames(), [&](const Vector3d& step) {
      for (int axis = 0; axis < 3; ++axis) {
        if (step[axis] > 0.0) grid[axis] = std::min(grid[axis], step[axis]);
      }
    });
  }
  bool fits = true;
  for (int k = 0; k < points.count() && fits; ++k) {
    ForSteps(points, k, 0, points.frames(), [&](const Vector3d& step) {
      for (int axis = 0; axis < 3; ++axis) {
        const double steps = step[axis] / grid[axis];
        fits = fits && std::abs(steps - std::round(steps)) < kOff;
      }
    });
  }
  return fits ? std::optional(grid) : std::nullopt;
}

/// How many stillnesses as long as that of point `k` from frame `begin` to before `end` a clip on the grid shows by
/// chance: a sample that moves by m grid steps a frame on average, measured around the stillness, falls on its place
/// again once in 1 + 2 m times along each axis.
double ExpectedByChance(const TrackedPoints& points, const Vector3d& grid, int k, int begin, int end) {
  constexpr int kAround = 8;  // frames before and after
  Vector3d moved = Vector3d::Zero();
  int steps = 0;
  const auto add = [&](const Vector3d& step) {
    moved += step.cwiseQuotient(grid);
    ++steps;
  };
  ForSteps(points, k, begin + 1 - kAround, begin + 1, add);
  ForSteps(points, k, end, end + kAround, add);
  if (steps == 0) return 0.0;
  const Vector3d often = (Vector3d::Ones() + 2.0 * moved / steps).cwiseInverse();
  return std::pow(often.prod(), end - begin - 1) * points.frames() * points.count();
}

/// Calls with [begin, end) of each run of frames in which `holds`.
void ForRuns(int frames, const std::function<bool(int)>& holds, const std::function<void(int, int)>& call) {
  for (int f = 0; f < frames; ++f) {
    if (!holds(f)) continue;
    const int begin = f;
    while (f < frames && holds(f)) ++f;
    call(begin, f);
  }
}

/// What repeats from the frame before: per joint and for the body.
class Repeats {
 public:
  explicit Repeats(const TrackedPoints& points)
      : points_(points), moves_(static_cast<std::size_t>(points.count())), grid_(GridOf(points)) {
    for (int k = 0; k < points.count(); ++k) {
      for (int f = 1; f < points.frames(); ++f) {
        if (!BothSeen(f, k) || Same(f, k)) continue;
        moves_[static_cast<std::size_t>(k)] = 1;
        break;
      }
    }
    moving_ = static_cast<int>(std::count(moves_.begin(), moves_.end(), 1));
    for (int k = 0; k < points.count(); ++k) seen_ += EverSeen(k) ? 1 : 0;
  }

  bool Moves(int k) const { return moves_[static_cast<std::size_t>(k)] != 0; }

  /// Whether a joint without motion is a repeated value: most other joints move, and so does its parent. A fixed root,
  /// and joints fixed to it, are intended.
  bool HeldThroughout(int k) const {
    if (2 * moving_ <= seen_) return false;
    if (points_.parents.empty()) return true;
    const int parent = points_.parents[static_cast<std::size_t>(k)];
    return parent >= 0 && Moves(parent);
  }
  bool Joint(int f, int k) const { return f > 0 && BothSeen(f, k) && Same(f, k); }

  /// Every joint that ever moves repeats, and the same joints are observed. In a clip without motion, every joint.
  bool Body(int f) const {
    bool any = false;
    for (int k = 0; f > 0 && k < points_.count(); ++k) {
      if (points_.sees(f, k) != points_.sees(f - 1, k)) return false;
      if (!points_.sees(f, k) || (!Moves(k) && moving_ > 0)) continue;
      if (!Same(f, k)) return false;
      any = true;
    }
    return any;
  }

  /// Whether a hold of [begin, end) begins or ends abruptly: with a step of more than kAbrupt, and more than half of
  /// the step beyond. True for a hold without an observed end.
  bool Abrupt(int begin, int end, int k) const {
    const std::optional<bool> into = Stops(begin, begin - 1, k), out_of = Stops(end, end + 1, k);
    return (!into && !out_of) || into.value_or(false) || out_of.value_or(false);
  }

  /// Whether samples rounded to a grid explain such a hold by chance or as the end of a slow movement. On a coarse grid
  /// every hold begins and ends with a step.
  bool ByGrid(int begin, int end, int k) const {
    if (!grid_) return false;
    if (!Moves(k)) return end - begin <= kBeyondOthers * LongestStillness();
    if (ExpectedByChance(points_, *grid_, k, begin, end) > kByChance) return true;
    const auto softly = [&](int f) {
      if (f < 1 || f >= points_.frames() || !BothSeen(f, k)) return true;
      const Vector3d step = points_.at(f, k) - points_.at(f - 1, k);
      return step.cwiseAbs().cwiseQuotient(*grid_).maxCoeff() < 2.5;
    };
    const bool coarse = grid_->minCoeff() > 0.5 * kAbrupt;
    return coarse && softly(begin) && softly(end);
  }

  bool AbruptBody(int begin, int end) const {
    for (int k = 0; k < points_.count(); ++k) {
      if (Abrupt(begin, end, k)) return true;
    }
    return false;
  }

 private:
  bool BothSeen(int f, int k) const { return points_.sees(f, k) && points_.sees(f - 1, k); }
  /// Whether the step into f is more than kAbrupt and more than half of the one into `beyond`; empty where it is not
  /// observed.
  std::optional<bool> Stops(int f, int beyond, int k) const {
    if (f < 1 || f >= points_.frames() || !BothSeen(f, k)) return std::nullopt;
    const bool seen = beyond >= 1 && beyond < points_.frames() && BothSeen(beyond, k);
    return Step(f, k) > kAbrupt && (!seen || Step(f, k) > 0.5 * Step(beyond, k));
  }
  double Step(int f, int k) const { return (points_.at(f, k) - points_.at(f - 1, k)).norm(); }
  bool EverSeen(int k) const {
    for (int f = 0; f < points_.frames(); ++f) {
      if (points_.sees(f, k)) return true;
    }
    return false;
  }
  /// Frames of the longest stillness of a joint that moves.
  int LongestStillness() const {
    if (longest_) return *longest_;
    int longest = 0;
    for (int k = 0; k < points_.count(); ++k) {
      if (!Moves(k)) continue;
      ForRuns(
          points_.frames(), [&](int f) { return Joint(f, k); },
          [&](int begin, int end) { longest = std::max(longest, end - begin + 1); });
    }
    longest_ = longest;
    return longest;
  }
  bool Same(int f, int k) const { return points_.at(f, k) == points_.at(f - 1, k); }

  const TrackedPoints& points_;
  std::vector<char> moves_;
  std::optional<Vector3d> grid_;
  int seen_ = 0, moving_ = 0;           ///< joints
  mutable std::optional<int> longest_;  ///< of LongestStillness
};

/// A joint that repeats its value exactly in [begin, end) while others move.
struct Hold {
  int joint = 0;
  int begin = 0;
  int end = 0;
  bool abrupt = false;
};

std::vector<Hold> FindHolds(const TrackedPoints& points, const Repeats& repeats, int fewest) {
  std::vector<Hold> holds;
  for (int k = 0; k < points.count(); ++k) {
    if (!repeats.Moves(k) && !repeats.HeldThroughout(k)) continue;
    const auto repeated = [&](int f) { return repeats.Joint(f, k); };
    ForRuns(points.frames(), repeated, [&](int begin, int end) {
      int others = 0;  // steps in which something else moves
      for (int f = begin; f < end; ++f) others += repeats.Body(f) ? 0 : 1;
      if (end - begin + 1 < fewest || others == 0 || repeats.ByGrid(begin - 1, end, k)) return;
      holds.push_back({k, begin - 1, end, repeats.Abrupt(begin - 1, end, k)});
    });
  }
  return holds;
}

/// Mean number of copies where nearly all frames are repeated two to four times; else 0.
double TimesRepeated(const TrackedPoints& points, const std::function<bool(int)>& body) {
  int runs = 0, covered = 0;
  ForRuns(points.frames(), body, [&](int begin, int end) {
    const int count = end - begin + 1;
    if (count > kMostTimes) return;  // a stream that hung
    ++runs;
    covered += count;
  });
  const bool nearly_all = covered >= kNearlyAll * points.frames();
  return runs >= kFewestRepeated && nearly_all ? static_cast<double>(covered) / runs : 0.0;
}

Finding RepeatedFrames(const TrackedPoints& points, double times) {
  const double hz = (points.frames() - 1) / (points.time_s.back() - points.time_s.front());
  return FrameFinding("repeated_frames", 0, points.frames(), "", times,
                      "nearly all frames are repeated " + Digits(times) + " times (mean): a recording of " +
                          Digits(hz / times) + " Hz written at " + Digits(hz) + " Hz, or one of " + Digits(hz) +
                          " Hz with a wrong declared rate; keep one frame of each repetition");
}

}  // namespace

std::vector<Finding> FindRepeats(const TrackedPoints& points, const RepeatLimits& limits) {
  std::vector<Finding> findings;
  const Repeats repeats(points);
  const auto body = [&](int f) { return repeats.Body(f); };
  const double times = TimesRepeated(points, body);
  if (times > 0.0) return {RepeatedFrames(points, times)};
  ForRuns(points.frames(), body, [&](int begin, int end) {
    const int count = end - begin + 1;  // with the frame that is repeated
    if (count < limits.frozen_frames || !repeats.AbruptBody(begin - 1, end)) return;
    findings.push_back(
        FrameFinding("frozen_frames", begin - 1, end, "", count,
                     Counted(count, "frame") + " are equal to the last digit: written twice, or the stream hung"));
    if (count == 2) findings.back().severity = Severity::kInfo;
  });
  const std::vector<Hold> holds = FindHolds(points, repeats, limits.held_frames);
  const auto abrupt = std::count_if(holds.begin(), holds.end(), [](const Hold& hold) { return hold.abrupt; });
  const bool sensed = 2 * abrupt > static_cast<std::ptrdiff_t>(holds.size());
  for (const Hold& hold : sensed ? holds : std::vector<Hold>()) {
    const int count = hold.end - hold.begin;
    findings.push_back(FrameFinding("repeated_value", hold.begin, hold.end, points.name(hold.joint), count,
                                    "'" + points.name(hold.joint) + "' repeats its value to the last digit for " +
                                        Counted(count, "frame") +
                                        " while other joints move: a gap filled with the last value"));
  }
  return findings;
}

std::vector<Finding> FindBlanks(const TrackedPoints& points) {
  std::vector<Finding> findings;
  const auto zero = [&](int f, int k) { return points.sees(f, k) && points.at(f, k).isZero(0.0); };
  const auto all_zero = [&](int f) {
    bool any = false;
    for (int k = 0; k < points.count(); ++k) {
      if (points.sees(f, k) && !zero(f, k)) return false;
      any = any || zero(f, k);
    }
    return any && points.count() > 1;
  };
  ForRuns(points.frames(), all_zero, [&](int begin, int end) {
    findings.push_back(
        FrameFinding("zero_frames", begin, end, "", end - begin,
                     "every joint is at 0 0 0 in " + Counted(end - begin, "frame") + ": no valid samples"));
  });
  const auto collapsed = [&](int f) {
    if (all_zero(f)) return false;
    const auto size = points.Extent(f, 3);
    return size && *size < kCollapsed;
  };
  ForRuns(points.frames(), collapsed, [&](int begin, int end) {
    findings.push_back(
        FrameFinding("collapsed_frames", begin, end, "", end - begin,
                     "all joints lie in one point in " + Counted(end - begin, "frame") + ": not a body"));
  });
  for (int k = 0; k < points.count(); ++k) {
    const auto alone = [&](int f) { return zero(f, k) && !all_zero(f); };
    const bool root = !points.parents.empty() && points.parents[static_cast<std::size_t>(k)] < 0;
    int zeros = 0, seen = 0;
    for (int f = 0; f < points.frames(); ++f) {
      zeros += alone(f) ? 1 : 0;
      seen += points.sees(f, k) && !all_zero(f) ? 1 : 0;
    }
    if (root && zeros == seen) continue;  // the clip's origin
    ForRuns(points.frames(), alone, [&](int begin, int end) {
      if (root && begin == 0 && end == 1) return;  // a clip that starts there
      findings.push_back(FrameFinding("zero_joint", begin, end, points.name(k), end - begin,
                                      "'" + points.name(k) + "' is at 0 0 0 in " + Counted(end - begin, "frame") +
                                          ": a tracker's mark for a joint it does not observe"));
    });
  }
  return findings;
}

}  // namespace mocurate
