#include "fitting/clouds/capsule_fit.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fitting/clouds/cloud_problem.h"
#include "fitting/solver/one_thread.h"

namespace mocurate {
namespace {

constexpr double kSettled = 1e-3;        ///< m; joints move less on average: well below the error of the body
constexpr int kWideMatchings = 4;        ///< look farther than the later ones
constexpr int kSolverSteps = 4;          ///< between two matchings
constexpr double kComparedSigma = 0.01;  ///< m; error of a capsule body

ceres::Solver::Options SolverOptions() {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.num_threads = 1;
  solver.max_num_iterations = kSolverSteps;
  solver.function_tolerance = 1e-4;
  solver.logging_type = ceres::SILENT;
  return solver;
}

std::vector<Vector3d> JointsOf(const PoseState& state, int frame) {
  std::vector<Vector3d> joints;
  for (int j = 0; j < state.joints(); ++j) joints.push_back(state.position(frame, j));
  return joints;
}

double MeanMove(const std::vector<Vector3d>& before, const std::vector<Vector3d>& after) {
  double sum = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) sum += (after[i] - before[i]).norm();
  return sum / static_cast<double>(before.size());
}

/// From the first matching's down to 1 over a few matchings.
double Widening(double first, int iteration) {
  return 1.0 + (first - 1.0) * std::max(0.0, 1.0 - static_cast<double>(iteration) / kWideMatchings);
}

}  // namespace

Expected<CapsuleFitOutcome> FitCloudFrame(const FleshBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                          PoseState& state, const PointCloudOptions& options) {
  CapsuleFitOutcome outcome;
  const int frame = fit.frame;
  for (int i = 0; i < fit.iterations && !outcome.converged; ++i) {
    state.Update(frame, frame + 1, false);
    const double widening = Widening(fit.widening, i);
    const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, widening * options.max_distance);
    std::vector<double> distances;
    for (const CloudMatch& match : matches) distances.push_back(match.distance);
    outcome.sigma = RobustSigma(std::move(distances));
    CloudProblem problem(body, state, {frame, frame + 1, fit.since_previous_s}, outcome.sigma, options);
    problem.AddFrame(frame, cloud, matches);
    if (fit.since_previous_s) problem.AddStep();

    const std::vector<Vector3d> before = JointsOf(state, frame);
    ceres::Solver::Summary summary;
    const OneThread one_thread;
    ceres::Solve(SolverOptions(), &problem.problem(), &summary);
    if (!summary.IsSolutionUsable()) {
      return Fail(ErrorCode::kInconsistent, "the solver failed: " + summary.message, "frame " + std::to_string(frame));
    }
    if (i == 0) outcome.initial_cost = summary.initial_cost;
    outcome.final_cost = summary.final_cost;
    ++outcome.iterations;
    state.Update(frame, frame + 1, false);
    outcome.moved = MeanMove(before, JointsOf(state, frame));
    outcome.converged = widening == 1.0 && outcome.moved < kSettled;
  }
  return outcome;
}

Expected<double> PoseCost(const FleshBody& body, const FusedCloud& cloud, PoseState& state, int frame,
                          const PointCloudOptions& options) {
  const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, options.max_distance);
  CloudProblem problem(body, state, {frame, frame + 1, std::nullopt}, kComparedSigma, options);
  problem.AddFrame(frame, cloud, matches);
  double cost = 0.0;
  if (!problem.problem().Evaluate({}, &cost, nullptr, nullptr, nullptr)) {
    return Fail(ErrorCode::kInternal, "a pose cannot be evaluated", "frame " + std::to_string(frame));
  }
  return cost + problem.CostOfPoint(options.max_distance) * (cloud.size() - static_cast<double>(matches.size()));
}

double MeanDistance(const FleshBody& body, const FusedCloud& cloud, const PoseState& state, int frame,
                    double max_distance) {
  if (cloud.size() == 0) return 0.0;
  double sum = 0.0;
  const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, max_distance);
  for (const CloudMatch& match : matches) sum += std::abs(match.distance);
  return (sum + max_distance * (cloud.size() - static_cast<double>(matches.size()))) / cloud.size();
}

}  // namespace mocurate
