#include <algorithm>
#include <cmath>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/track_equations.h"

namespace mocurate {
namespace {

/// Damping of Levenberg-Marquardt and how it follows the success of steps, as in Ceres: Nielsen 1999, section 2.
class TrustRegion {
 public:
  Eigen::VectorXd Damping(const Eigen::VectorXd& diagonal) const {
    return diagonal.cwiseMax(kSmallestDiagonal * diagonal.maxCoeff()) / radius_;
  }
  /// `gain`: decrease of the cost over what the quadratic model foresaw.
  void Accept(double gain) {
    radius_ = std::min(radius_ / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)), kLargestRadius);
    shrink_ = 2.0;
  }
  void Reject() {
    radius_ /= shrink_;
    shrink_ *= 2.0;
  }
  bool exhausted() const { return radius_ < kSmallestRadius; }

 private:
  static constexpr double kSmallestDiagonal = 1e-12;
  static constexpr double kLargestRadius = 1e16;
  static constexpr double kSmallestRadius = 1e-32;
  double radius_ = 1e4;
  double shrink_ = 2.0;
};

constexpr double kSmallestGain = 1e-3;  ///< of an accepted step

}  // namespace

Expected<WindowSolution> SolveBanded(const TrackWindow& window) {
  const OneThread one_thread;
  TrackEquations track(window);
  BlockTridiagonal equations(window.end - window.begin, track.size(), track.border());
  TrustRegion region;
  Eigen::VectorXd parameters = track.Parameters();
  track.SetParameters(parameters);
  WindowSolution solution;
  double cost = solution.initial_cost = track.Cost();
  if (!std::isfinite(cost)) return Fail(ErrorCode::kInternal, "the cost of the start is no number", "fitting");
  bool moved = true;
  while (solution.iterations < window.options.max_iterations && !region.exhausted()) {
    if (moved) track.Linearise(equations);
    moved = false;
    ++solution.iterations;
    const Eigen::VectorXd damping = region.Damping(equations.DiagonalEntries());
    if (!equations.Factor(damping)) {
      region.Reject();
      continue;
    }
    const Eigen::VectorXd step = equations.Solve();
    const double foreseen = 0.5 * (step.dot(damping.cwiseProduct(step)) - step.dot(equations.GradientEntries()));
    track.SetParameters(parameters + step);
    const double next = track.Cost();
    const double gain = (cost - next) / foreseen;
    if (!(foreseen > 0.0) || !(gain > kSmallestGain)) {
      track.SetParameters(parameters);
      // At the minimum rounding decides: nothing more is to be had.
      if (foreseen <= 1e-3 * window.options.relative_tolerance * cost) {
        solution.converged = true;
        break;
      }
      region.Reject();
      continue;
    }
    parameters += step;
    region.Accept(gain);
    moved = true;
    const bool settled = cost - next <= window.options.relative_tolerance * cost;
    cost = next;
    if (settled) {
      solution.converged = true;
      break;
    }
  }
  solution.final_cost = cost;
  return solution;
}

}  // namespace mocurate
