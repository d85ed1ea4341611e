#include "fitting/solver/solve.h"

#include <cmath>
#include <string>

#include "fitting/solver/ceres_poses.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/solver/trust_region.h"
#include "fitting/stop_request.h"

namespace mocurate {
namespace {

Expected<Solution> SolveBanded(const PoseTerms& terms, PoseState& state, const SolveOptions& options) {
  PoseEquations pose(state);
  BlockTridiagonal own;
  BlockTridiagonal& equations = options.memory != nullptr ? *options.memory : own;
  equations.Resize(static_cast<int>(terms.frames.size()), pose.columns().size());
  TrustRegion region;
  Eigen::VectorXd unknowns = pose.columns().Read(terms, state);
  Solution solution;
  double cost = solution.initial_cost = Cost(terms, state);
  if (!std::isfinite(cost)) {
    return Fail(ErrorCode::kInconsistent, "the cost of the initial pose is not finite", FramesOf(terms), kCheckFrames);
  }
  bool moved = true;
  while (solution.iterations < options.max_iterations && !region.exhausted()) {
    if (Status on = StopIfInterrupted(options.of); !on) return Forward(on);
    if (moved) pose.Linearise(terms, state, equations);
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
    pose.columns().Write(terms, unknowns + step, state);
    const double next = Cost(terms, state);
    const double gain = (cost - next) / predicted_decrease;
    if (!(predicted_decrease > 0.0) || !(gain > TrustRegion::kSmallestGain)) {
      pose.columns().Write(terms, unknowns, state);
      // At the minimum, rounding decides the sign of the decrease.
      if (predicted_decrease <= 1e-3 * options.relative_tolerance * cost) {
        solution.converged = true;
        break;
      }
      region.Reject();
      continue;
    }
    unknowns += step;
    region.Accept(gain);
    moved = true;
    const bool settled = cost - next <= options.relative_tolerance * cost;
    cost = next;
    if (settled || options.one_step) {
      solution.converged = true;
      break;
    }
  }
  solution.exhausted = !solution.converged && region.exhausted();
  solution.final_cost = cost;
  return solution;
}

}  // namespace

std::string FramesOf(const PoseTerms& terms) {
  return "frames " + std::to_string(terms.frames.front().frame) + " to " + std::to_string(terms.frames.back().frame);
}

Expected<Solution> Solve(const PoseTerms& terms, PoseState& state, const SolveOptions& options) {
  const OneThread one_thread;
  for (const FrameTerms& frame : terms.frames) state.Update(frame.frame, frame.frame + 1, true);
  return options.solver == PoseSolver::kBanded ? SolveBanded(terms, state, options)
                                               : SolveWithCeres(terms, state, options);
}

}  // namespace mocurate
