#include "fitting/solver/track_problem.h"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <string>

#include "core/pipeline/worker.h"
#include "fitting/costs/joint_limit_cost.h"
#include "fitting/costs/joint_position_cost.h"
#include "fitting/costs/joint_rotation_cost.h"
#include "fitting/costs/joint_velocity_cost.h"
#include "fitting/costs/rest_prior_cost.h"
#include "fitting/costs/rotation_smoothness_cost.h"
#include "fitting/solver/one_thread.h"
#include "fitting/stop_request.h"

namespace mocurate {
namespace {

/// W with W'W = information.
Matrix3d Whitening(const Matrix3d& information) { return Eigen::LLT<Matrix3d>(information).matrixU(); }

}  // namespace

TrackProblem::TrackProblem(const TrackWindow& window)
    : window_(window),
      state_(window.state),
      hinges_(HingesOf(*window.tracks.skeleton)),
      update_(window.state, window.first(), window.end),
      loss_(window.options.huber_sigmas),
      problem_(PoseProblemOptions(update_)) {
  for (int f = window.begin; f < window.end; ++f) AddFrame(f);
  for (int f = window.first(); f + 1 < window.end; ++f) {
    if (window.Joined(f)) AddStep(f);
  }
  if (!window.after_fixed) return;
  std::vector<double*> fixed{state_.translation(window.begin - 1)};
  for (int j = 0; j < state_.joints(); ++j) fixed.push_back(state_.rotation(window.begin - 1, j));
  for (double* block : fixed) {
    if (problem_.HasParameterBlock(block)) problem_.SetParameterBlockConstant(block);
  }
}

void TrackProblem::AddFrame(int frame) {
  for (int j = 0; j < state_.joints(); ++j) {
    if (window_.tracks.seen(frame, j)) {
      const Matrix3d whitening = Whitening(window_.Information(frame, j));
      auto* cost = new JointPositionCost(state_, frame, j, window_.tracks.positions.at(frame, j), whitening);
      problem_.AddResidualBlock(cost, &loss_, cost->Blocks(state_));
    }
    const std::size_t at = window_.Index(frame, j);
    if (window_.rotations != nullptr && window_.rotations->has(at)) {
      auto* cost = new JointRotationCost(state_, frame, j, window_.rotations->world_from_joint[at],
                                         window_.rotations->weight[at]);
      problem_.AddResidualBlock(cost, &loss_, cost->Blocks(state_));
    }
    if (j == 0 || !state_.active(j)) continue;
    problem_.AddResidualBlock(new RestPriorCost(1.0 / std::sqrt(window_.RestInformation(frame, j))), nullptr,
                              state_.rotation(frame, j));
    if (const auto& limits = window_.tracks.skeleton->joints[j].limits) {
      problem_.AddResidualBlock(new JointLimitCost(*limits, window_.options.limit_sigma), nullptr,
                                state_.rotation(frame, j));
    }
    if (hinges_[j]) {
      problem_.AddResidualBlock(new HingeCost(*hinges_[j], window_.options.hinge_sigma), nullptr,
                                state_.rotation(frame, j));
    }
  }
}

void TrackProblem::AddStep(int frame) {
  for (int j = 0; j < state_.joints(); ++j) {
    const double rotation_weight = 1.0 / std::sqrt(window_.RotationVariance(frame, j));
    const double velocity_weight = 1.0 / std::sqrt(window_.MoveVariance(frame, j));
    if (state_.active(j)) {
      problem_.AddResidualBlock(new RotationSmoothnessCost(state_, frame, j, rotation_weight), nullptr,
                                state_.rotation(frame, j), state_.rotation(frame + 1, j));
    }
    auto* cost = new JointVelocityCost(state_, frame, j, velocity_weight);
    problem_.AddResidualBlock(cost, nullptr, cost->Blocks(state_));
  }
}

namespace {

/// Ends the solver when the worker receives a stop request.
class StopOnRequest : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return StopRequested() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
};

ceres::Solver::Options SparseSolverOptions(const TrackStep& step) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  solver.num_threads = 1;
  solver.function_tolerance = step.relative_tolerance;
  solver.gradient_tolerance = 1e-12;
  solver.parameter_tolerance = 1e-12;
  solver.max_num_iterations = static_cast<int>(step.max_iterations);
  solver.logging_type = ceres::SILENT;
  return solver;
}

}  // namespace

Expected<WindowSolution> SolveWithCeres(const TrackWindow& window) {
  TrackProblem problem(window);
  ceres::Solver::Summary summary;
  const OneThread one_thread;
  StopOnRequest stop;
  ceres::Solver::Options options = SparseSolverOptions(window.step);
  options.callbacks = {&stop};
  ceres::Solve(options, &problem.problem(), &summary);
  if (Status on = StopIfInterrupted("fit of joint tracks"); !on) return Forward(on);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kInconsistent, "the solver failed: " + summary.message,
                "frames " + std::to_string(window.begin) + " to " + std::to_string(window.end),
                "check that these frames show a person, in metres");
  }
  WindowSolution solution;
  solution.iterations = static_cast<int>(summary.iterations.size()) - 1;
  solution.initial_cost = summary.initial_cost;
  solution.final_cost = summary.final_cost;
  solution.converged = summary.termination_type != ceres::NO_CONVERGENCE;
  return solution;
}

}  // namespace mocurate
