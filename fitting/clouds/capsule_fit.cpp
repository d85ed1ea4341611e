#include "fitting/clouds/capsule_fit.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fitting/clouds/cloud_problem.h"
#include "fitting/solver/one_thread.h"

namespace mocurate {
namespace {

constexpr double kSettled = 1e-3;  ///< m; joints move less on average: well below the error of the body
constexpr double kWidening = 2.0;  ///< the first matching looks this much farther than the later ones
constexpr int kSolverSteps = 4;    ///< between two matchings

ceres::Solver::Options SolverOptions() {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
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

/// From kWidening down to 1 over the first half of the matchings.
double Widening(int iteration, int iterations) {
  return 1.0 + (kWidening - 1.0) * std::max(0.0, 1.0 - 2.0 * iteration / iterations);
}

}  // namespace

Expected<CapsuleFitOutcome> FitCloudFrame(const FleshBody& body, const std::vector<FusedCloud>& clouds,
                                          PoseState& state, int frame, bool after_previous, double frame_seconds,
                                          const PointCloudOptions& options) {
  CapsuleFitOutcome outcome;
  const int iterations = static_cast<int>(options.iterations);
  for (int i = 0; i < iterations && !outcome.converged; ++i) {
    state.Update(frame, frame + 1, false);
    const double widening = Widening(i, iterations);
    const std::vector<CloudMatch> matches =
        MatchPoints(body, state, frame, clouds[frame], widening * options.max_distance);
    std::vector<double> distances;
    for (const CloudMatch& match : matches) distances.push_back(match.distance);
    outcome.sigma = RobustSigma(std::move(distances));
    CloudProblem problem(body, state, {frame, frame + 1, after_previous, frame_seconds}, outcome.sigma, options);
    problem.AddFrame(frame, clouds[frame], matches);
    if (after_previous) problem.AddStep();

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
    outcome.converged = widening == 1.0 && MeanMove(before, JointsOf(state, frame)) < kSettled;
  }
  return outcome;
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
