#include <cmath>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/track_equations.h"
#include "fitting/solver/trust_region.h"
#include "fitting/stop_request.h"

namespace mocurate {

Expected<WindowSolution> SolveBanded(const TrackWindow& window) {
  const OneThread one_thread;
  TrackEquations track(window);
  BlockTridiagonal own;
  BlockTridiagonal& equations = window.memory != nullptr ? *window.memory : own;
  equations.Resize(window.end - window.begin, track.size());
  TrustRegion region;
  Eigen::VectorXd parameters = track.Parameters();
  track.SetParameters(parameters);
  WindowSolution solution;
  double cost = solution.initial_cost = track.Cost();
  if (!std::isfinite(cost)) {
    return Fail(ErrorCode::kInconsistent, "the cost of the initial pose is not finite",
                "frames " + std::to_string(window.begin) + " to " + std::to_string(window.end),
                "check that these frames show a person, in metres");
  }
  bool moved = true;
  while (solution.iterations < window.step.max_iterations && !region.exhausted()) {
    if (Status on = StopIfInterrupted("fit of joint tracks"); !on) return Forward(on);
    if (moved) track.Linearise(equations);
    moved = false;
    ++solution.iterations;
    const Eigen::VectorXd damping = region.Damping(equations.DiagonalEntries());
    if (!equations.Factor(damping)) {
      region.Reject();
      continue;
    }
    const Eigen::VectorXd step = equations.Solve();
    const double predicted_decrease =
        0.5 * (step.dot(damping.cwiseProduct(step)) - step.dot(equations.GradientEntries()));
    track.SetParameters(parameters + step);
    const double next = track.Cost();
    const double gain = (cost - next) / predicted_decrease;
    if (!(predicted_decrease > 0.0) || !(gain > TrustRegion::kSmallestGain)) {
      track.SetParameters(parameters);
      // At the minimum, rounding decides the sign of the decrease.
      if (predicted_decrease <= 1e-3 * window.step.relative_tolerance * cost) {
        solution.converged = true;
        break;
      }
      region.Reject();
      continue;
    }
    parameters += step;
    region.Accept(gain);
    moved = true;
    const bool settled = cost - next <= window.step.relative_tolerance * cost;
    cost = next;
    if (settled) {
      solution.converged = true;
      break;
    }
  }
  solution.exhausted = !solution.converged && region.exhausted();
  solution.final_cost = cost;
  return solution;
}

}  // namespace mocurate
