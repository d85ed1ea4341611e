#include "core/quality/axes_changes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/median.h"
#include "core/quality/swaps.h"

namespace mocurate {
namespace {

constexpr int kFewestTurnedPoints = 5;
constexpr double kFarTurned = 0.25;  // least step about the centre, in body sizes
// Largest share of that step that remains once the axes are changed back. The 220 other large steps in the recorded
// clips (missing frames, trackers that reverse a body) leave at least 0.21.
constexpr double kNearTurned = 0.15;
constexpr double kUsualTimes = 4.0;   // residual, in the clip's usual steps
constexpr double kAlikeSwap = 1.5;    // an exchange of sides leaves at most this many times the residual
constexpr double kAlikeAxes = 1.3;    // other changes of axes likewise
constexpr double kClearlyMore = 2.0;  // ratio of frames with the usual axes to those with others
constexpr int kLongestLost = 5;       // frames over which a body is still compared with its last known state

/// The 47 signed permutations of the axes other than the identity.
const std::vector<Matrix3d>& ChangesOfAxes() {
  static const std::vector<Matrix3d> changes = [] {
    std::vector<Matrix3d> all;
    int order[3] = {0, 1, 2};
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Matrix3d change = Matrix3d::Zero();
        for (int row = 0; row < 3; ++row) change(row, order[row]) = (signs >> row & 1) != 0 ? -1.0 : 1.0;
        if (change != Matrix3d::Identity()) all.push_back(change);
      }
    } while (std::next_permutation(order, order + 3));
    return all;
  }();
  return changes;
}

/// What two frames show of one body, about its middle in each.
struct StepOfBody {
  std::vector<Vector3d> before, after;  ///< of points that both see
  std::vector<Vector3d> exchanged;      ///< of `before`, with the sides exchanged
  Vector3d middle_before = Vector3d::Zero(), middle_after = Vector3d::Zero();
  double size = 0.0;  ///< root mean square distance from the middle

  bool empty() const { return before.empty(); }
  double Left(const Matrix3d& change, const std::vector<Vector3d>& from) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < after.size(); ++i) sum += (after[i] - change * from[i]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(after.size()));
  }
  double Length() const { return Left(Matrix3d::Identity(), before); }
  std::vector<double> LeftOfChanges() const {
    std::vector<double> left;
    for (const Matrix3d& change : ChangesOfAxes()) left.push_back(Left(change, before));
    return left;
  }
};

class BodySteps {
 public:
  explicit BodySteps(const TrackedPoints& points) : points_(points), other_(static_cast<std::size_t>(points.count())) {
    for (int k = 0; k < points.count(); ++k) other_[static_cast<std::size_t>(k)] = k;
    if (points.names.empty()) return;
    const LimbPairs pairs = FindLimbPairs(points.names);
    for (const auto* limbs : {&pairs.arms, &pairs.legs}) {
      for (const auto& [left, right] : *limbs) {
        other_[static_cast<std::size_t>(left)] = right;
        other_[static_cast<std::size_t>(right)] = left;
      }
    }
    for (const auto& pair : pairs.face) {
      for (const int k : pair) other_[static_cast<std::size_t>(k)] = -1;
    }
  }

  /// Of all points observed in both frames; empty where there are too few.
  StepOfBody Whole(int from, int to) const { return Step(from, to, false); }
  /// The same of points without a side and of limbs whose other side is observed too. Limbs of one side alone are no
  /// evidence of an exchange, and a tracker may exchange limbs with or without the face.
  StepOfBody Sides(int from, int to) const { return Step(from, to, true); }

 private:
  bool Seen(int from, int to, int k) const { return k >= 0 && points_.sees(from, k) && points_.sees(to, k); }
  StepOfBody Step(int from, int to, bool sides) const {
    StepOfBody step;
    std::vector<int> seen;
    for (int k = 0; k < points_.count(); ++k) {
      if (Seen(from, to, k) && (!sides || Seen(from, to, other_[static_cast<std::size_t>(k)]))) seen.push_back(k);
    }
    if (static_cast<int>(seen.size()) < kFewestTurnedPoints) return step;
    for (const int k : seen) {
      step.middle_before += points_.at(from, k) / static_cast<double>(seen.size());
      step.middle_after += points_.at(to, k) / static_cast<double>(seen.size());
    }
    double squares = 0.0;
    for (const int k : seen) {
      step.before.push_back(points_.at(from, k) - step.middle_before);
      step.after.push_back(points_.at(to, k) - step.middle_after);
      if (sides) step.exchanged.push_back(points_.at(from, other_[static_cast<std::size_t>(k)]) - step.middle_before);
      squares += step.before.back().squaredNorm();
    }
    step.size = std::sqrt(squares / static_cast<double>(seen.size()));
    return step;
  }

  const TrackedPoints& points_;
  std::vector<int> other_;  ///< (K) the point of the other side; itself on the midline, -1 for a point of the face
};

/// A step as bodies make them between frames: most points go little, though some may stray.
bool Stays(const StepOfBody& step) {
  if (step.empty()) return false;
  std::vector<double> ways;
  for (std::size_t i = 0; i < step.after.size(); ++i) ways.push_back((step.after[i] - step.before[i]).norm());
  return Median(ways) < kFarTurned * step.size;
}

/// Whether the step is an exchange of sides.
bool StaysExchanged(const StepOfBody& sides) {
  return !sides.empty() && sides.Left(Matrix3d::Identity(), sides.exchanged) < kFarTurned * sides.size;
}

/// The change of axes in a step; empty for a body motion or any other step.
std::optional<Matrix3d> ChangeIn(const BodySteps& steps, int from, int to, double usual) {
  const StepOfBody step = steps.Whole(from, to), sides = steps.Sides(from, to);
  if (step.empty() || sides.empty() || step.size <= 0.0) return std::nullopt;
  if (!(step.Length() >= kFarTurned * step.size)) return std::nullopt;
  const std::vector<Matrix3d>& changes = ChangesOfAxes();
  const std::vector<double> left = step.LeftOfChanges();
  const double least = *std::min_element(left.begin(), left.end());
  if (least > kNearTurned * step.Length()) return std::nullopt;
  if (least > kUsualTimes * usual * (to - from) + 1e-3 * step.size) return std::nullopt;
  // For bodies that look similar under several changes, the direction from the world's origin decides.
  std::optional<std::size_t> best;
  const auto jump = [&](std::size_t i) { return (sides.middle_after - changes[i] * sides.middle_before).norm(); };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (left[i] <= kAlikeAxes * least && (!best || jump(i) < jump(*best))) best = i;
  }
  // An exchange of sides does not move the body.
  const double stays = (sides.middle_after - sides.middle_before).norm();
  const double swapped = std::hypot(sides.Left(Matrix3d::Identity(), sides.exchanged), stays);
  const double turned = std::hypot(sides.Left(changes[*best], sides.before), std::min(stays, jump(*best)));
  if (swapped <= kAlikeSwap * turned) return std::nullopt;
  return changes[*best];
}

/// Consecutive frames in which the body can be followed, and the axes of each relative to the first.
struct Piece {
  int begin = 0;
  std::vector<Matrix3d> axes;
};

/// A frame that fits neither a step nor a change of axes (not observed, outliers) is skipped, and the next one is
/// compared with the last known frame. After too many skipped frames a new piece begins, as a change may be lost.
std::vector<Piece> Follow(const BodySteps& steps, int frames, double usual) {
  std::vector<Matrix3d> axes(static_cast<std::size_t>(frames), Matrix3d::Identity());
  std::vector<int> begins = {0};
  const auto of = [&](int f) -> Matrix3d& { return axes[static_cast<std::size_t>(f)]; };
  int known = 0, other = -1;  // the last frames with known axes: of these, and of the ones before
  for (int f = 1; f < frames; ++f) {
    of(f) = of(known);
    if (steps.Whole(known, known).empty()) known = f;
    if (const auto change = ChangeIn(steps, known, f, usual)) {
      for (int between = known + 1; between < f; ++between) {
        const StepOfBody part = steps.Whole(known, between);
        if (!part.empty() && part.Left(*change, part.before) < part.Length()) of(between) = *change * of(known);
      }
      of(f) = *change * of(known);
      other = known;
      known = f;
    } else if (Stays(steps.Whole(known, f)) || StaysExchanged(steps.Sides(known, f))) {
      known = f;
    } else if (other >= 0 && f - other <= kLongestLost && Stays(steps.Whole(other, f))) {
      of(f) = of(other);
      other = known;
      known = f;
    } else if (const auto next = ChangeIn(steps, f - 1, f, usual)) {
      of(f) = *next * of(f - 1);
      other = f - 1;
      known = f;
    } else if (f - known >= kLongestLost) {
      begins.push_back(known + 1);
      known = f;
      other = -1;
    }
  }
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < begins.size() && frames > 0; ++i) {
    const auto end = i + 1 < begins.size() ? axes.begin() + begins[i + 1] : axes.end();
    pieces.push_back({begins[i], std::vector<Matrix3d>(axes.begin() + begins[i], end)});
  }
  return pieces;
}

std::string ChangeWords(const Matrix3d& change) {
  std::string words;
  for (int row = 0; row < 3; ++row) {
    int column = 0;
    change.row(row).cwiseAbs().maxCoeff(&column);
    words += std::string(row == 0 ? "" : ", ") + "xyz"[row] + " is " + (change(row, column) < 0.0 ? "-" : "") +
             "xyz"[column];
  }
  return words;
}

/// The frames whose axes differ from those of most frames.
void ReportUnitChanges(const Piece& piece, std::vector<Finding>& findings) {
  const std::vector<Matrix3d>& axes = piece.axes;
  const auto count = [&](const Matrix3d& one) { return std::count(axes.begin(), axes.end(), one); };
  Matrix3d most = axes[0];
  for (std::size_t i = 1; i < axes.size(); ++i) {
    if (axes[i] != axes[i - 1] && count(axes[i]) > count(most)) most = axes[i];
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i] == most) continue;
    const int f = piece.begin + static_cast<int>(i);
    if (i > 0 && axes[i] == axes[i - 1]) {
      findings.back().frame_end = f + 1;
      continue;
    }
    const Matrix3d change = axes[i] * most.transpose();
    const double value = change.determinant() < 0.0 ? -1.0 : 1.0;
    const bool rare = kClearlyMore * static_cast<double>(count(axes[i])) <= static_cast<double>(count(most));
    findings.push_back(FrameFinding("axes_change", f, f + 1, "", value, ""));
    findings.back().message =
        std::string("the body is ") + (value < 0.0 ? "mirrored" : "turned") +
        " in these frames: relative to the other frames " + ChangeWords(change) +
        (rare ? "; change the axes of these frames back"
              : "; both groups are about equally large, so that the right one is ambiguous: change the axes of those "
                "that are wrong");
    findings.back().severity = Severity::kError;
  }
}

}  // namespace

std::vector<Finding> FindAxesChanges(const TrackedPoints& points) {
  const BodySteps steps(points);
  std::vector<double> lengths;
  for (int f = 1; f < points.frames(); ++f) {
    const StepOfBody step = steps.Whole(f - 1, f);
    if (step.empty()) continue;
    if (const double length = step.Length(); length > 0.0) lengths.push_back(length);
  }
  std::vector<Finding> findings;
  for (const Piece& piece : Follow(steps, points.frames(), Median(lengths))) ReportUnitChanges(piece, findings);
  return findings;
}

}  // namespace mocurate
