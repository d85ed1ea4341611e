#include "core/quality/axes_changes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/quality/median.h"
#include "core/quality/swaps.h"

namespace mocurate {
namespace {

constexpr int kFewestTurnedPoints = 5;
constexpr double kFarTurned = 0.25;  // least step about the middle, of the body's size
// Most of that step which is left once the axes are changed back; of 220 such steps in the recorded clips (frames that
// are missing, trackers that turn a body round) 0.21 at least.
constexpr double kNearTurned = 0.15;
constexpr double kUsualTimes = 4.0;  // what is left, beside the clip's usual step
constexpr double kAlikeSwap = 1.5;   // an exchange of sides leaves no more than so many times as much
constexpr double kAlikeAxes = 1.3;   // other axes likewise

/// The 47 changes of axes that are none: each axis becomes another, or itself, with either sign.
std::vector<Matrix3d> ChangesOfAxes() {
  std::vector<Matrix3d> changes;
  int order[3] = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3d change = Matrix3d::Zero();
      for (int row = 0; row < 3; ++row) change(row, order[row]) = (signs >> row & 1) != 0 ? -1.0 : 1.0;
      if (change != Matrix3d::Identity()) changes.push_back(change);
    }
  } while (std::next_permutation(order, order + 3));
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
};

StepOfBody StepTo(const TrackedPoints& points, int f, const std::vector<int>& other_side) {
  StepOfBody step;
  std::vector<int> seen;
  for (int k = 0; k < points.count(); ++k) {
    if (points.sees(f, k) && points.sees(f - 1, k)) seen.push_back(k);
  }
  if (static_cast<int>(seen.size()) < kFewestTurnedPoints) return step;
  for (const int k : seen) {
    step.middle_before += points.at(f - 1, k) / static_cast<double>(seen.size());
    step.middle_after += points.at(f, k) / static_cast<double>(seen.size());
  }
  double squares = 0.0;
  for (const int k : seen) {
    const int side = other_side[static_cast<std::size_t>(k)];
    const int other = points.sees(f - 1, side) ? side : k;
    step.before.push_back(points.at(f - 1, k) - step.middle_before);
    step.exchanged.push_back(points.at(f - 1, other) - step.middle_before);
    step.after.push_back(points.at(f, k) - step.middle_after);
    squares += step.before.back().squaredNorm();
  }
  step.size = std::sqrt(squares / static_cast<double>(seen.size()));
  return step;
}

std::vector<int> OtherSides(const TrackedPoints& points) {
  std::vector<int> other(static_cast<std::size_t>(points.count()));
  for (int k = 0; k < points.count(); ++k) other[static_cast<std::size_t>(k)] = k;
  if (points.names.empty()) return other;
  const LimbPairs pairs = FindLimbPairs(points.names);
  for (const auto* limbs : {&pairs.arms, &pairs.legs}) {
    for (const auto& [left, right] : *limbs) {
      other[static_cast<std::size_t>(left)] = right;
      other[static_cast<std::size_t>(right)] = left;
    }
  }
  return other;
}

/// The change of axes in a step; nothing where the step is one of a body, or of something else.
std::optional<Matrix3d> ChangeIn(const StepOfBody& step, double usual, const std::vector<Matrix3d>& changes) {
  const double straight = step.Left(Matrix3d::Identity(), step.before);
  if (!(straight >= kFarTurned * step.size) || step.size <= 0.0) return std::nullopt;
  std::vector<double> left;
  for (const Matrix3d& change : changes) left.push_back(step.Left(change, step.before));
  const double least = *std::min_element(left.begin(), left.end());
  if (least > kNearTurned * straight || least > kUsualTimes * usual + 1e-3 * step.size) return std::nullopt;
  // Bodies that are alike from several sides: the world's middle tells which change it is.
  std::optional<std::size_t> best;
  const auto jump = [&](std::size_t i) { return (step.middle_after - changes[i] * step.middle_before).norm(); };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (left[i] <= kAlikeAxes * least && (!best || jump(i) < jump(*best))) best = i;
  }
  // Sides that change leave a body where it is.
  const double stays = (step.middle_after - step.middle_before).norm();
  const double swapped = std::hypot(step.Left(Matrix3d::Identity(), step.exchanged), stays);
  if (swapped <= kAlikeSwap * std::hypot(least, std::min(stays, jump(*best)))) return std::nullopt;
  return changes[*best];
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

}  // namespace

std::vector<Finding> FindAxesChanges(const TrackedPoints& points) {
  const std::vector<int> other_side = OtherSides(points);
  std::vector<double> lengths;
  for (int f = 1; f < points.frames(); ++f) {
    const StepOfBody step = StepTo(points, f, other_side);
    if (step.empty()) continue;
    if (const double length = step.Left(Matrix3d::Identity(), step.before); length > 0.0) lengths.push_back(length);
  }
  const double usual = Median(lengths);
  const std::vector<Matrix3d> changes = ChangesOfAxes();
  std::vector<Matrix3d> axes(static_cast<std::size_t>(points.frames()), Matrix3d::Identity());
  bool any = false;
  for (int f = 1; f < points.frames(); ++f) {
    axes[static_cast<std::size_t>(f)] = axes[static_cast<std::size_t>(f) - 1];
    const StepOfBody step = StepTo(points, f, other_side);
    if (step.empty()) continue;
    if (const auto change = ChangeIn(step, usual, changes)) {
      axes[static_cast<std::size_t>(f)] = *change * axes[static_cast<std::size_t>(f) - 1];
      any = true;
    }
  }
  if (!any) return {};
  Matrix3d most = axes[0];
  for (const Matrix3d& candidate : axes) {
    if (std::count(axes.begin(), axes.end(), candidate) > std::count(axes.begin(), axes.end(), most)) most = candidate;
  }
  std::vector<Finding> findings;
  for (int f = 0; f < points.frames(); ++f) {
    const Matrix3d& own = axes[static_cast<std::size_t>(f)];
    if (own == most) continue;
    if (f > 0 && own == axes[static_cast<std::size_t>(f) - 1]) {
      findings.back().frame_end = f + 1;
      continue;
    }
    const Matrix3d change = own * most.transpose();
    const double value = change.determinant() < 0.0 ? -1.0 : 1.0;
    findings.push_back(FrameFinding("axes_change", f, f + 1, "", value, ""));
    findings.back().message = std::string("the body is ") + (value < 0.0 ? "mirrored" : "turned") +
                              " in these frames: against the other frames " + ChangeWords(change) +
                              "; change the axes of these frames back";
    findings.back().severity = Severity::kError;
  }
  return findings;
}

}  // namespace mocurate
