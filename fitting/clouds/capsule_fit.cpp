#include "fitting/clouds/capsule_fit.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fitting/clouds/cloud_equations.h"
#include "fitting/clouds/cloud_problem.h"
#include "fitting/costs/huber.h"
#include "fitting/solver/one_thread.h"

namespace mocurate {
namespace {

constexpr double kSettled = 1e-3;  ///< m; joints move less on average: well below the error of the body
constexpr int kWideMatchings = 4;  ///< look farther than the later ones
constexpr int kSolverSteps = 4;    ///< between two matchings
constexpr double kRelativeTolerance = 1e-4;
constexpr double kComparedSigma = 0.01;  ///< m; error of a capsule body

ceres::Solver::Options SolverOptions() {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.num_threads = 1;
  solver.max_num_iterations = kSolverSteps;
  solver.function_tolerance = kRelativeTolerance;
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

/// A frame's points, each held to its capsule.
struct MatchedFrame {
  const FleshBody& body;
  const FusedCloud& cloud;
  const std::vector<CloudMatch>& matches;
  const FrameFit& fit;
  double sigma = 0.0;
};

Expected<CloudSolution> SolveWithCeres(const MatchedFrame& matched, PoseState& state,
                                       const PointCloudOptions& options) {
  const int frame = matched.fit.frame;
  CloudProblem problem(matched.body, state, {frame, frame + 1, matched.fit.since_previous_s}, matched.sigma, options);
  problem.AddFrame(frame, matched.cloud, matched.matches);
  if (matched.fit.since_previous_s) problem.AddStep();
  ceres::Solver::Summary summary;
  const OneThread one_thread;
  ceres::Solve(SolverOptions(), &problem.problem(), &summary);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kInconsistent, "the solver failed: " + summary.message, "frame " + std::to_string(frame));
  }
  return CloudSolution{summary.initial_cost, summary.final_cost};
}

Expected<CloudSolution> SolveDense(const MatchedFrame& matched, PoseState& state, const PointCloudOptions& options) {
  CloudEquations equations(matched.body, state, matched.fit.frame, matched.cloud, matched.matches,
                           PointWeight(matched.sigma, options.voxel_size), matched.fit.since_previous_s, options);
  return SolveCloudEquations(equations, kSolverSteps, kRelativeTolerance);
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
    const std::vector<Vector3d> before = JointsOf(state, frame);
    const MatchedFrame matched{body, cloud, matches, fit, outcome.sigma};
    const auto solve = options.solver == TrackSolver::kBanded ? SolveDense : SolveWithCeres;
    const auto solution = solve(matched, state, options);
    if (!solution) return Forward(solution);
    if (i == 0) outcome.initial_cost = solution->initial_cost;
    outcome.final_cost = solution->final_cost;
    ++outcome.iterations;
    state.Update(frame, frame + 1, false);
    outcome.moved = MeanMove(before, JointsOf(state, frame));
    outcome.converged = widening == 1.0 && outcome.moved < kSettled;
  }
  return outcome;
}

double PoseCost(const FleshBody& body, const FusedCloud& cloud, PoseState& state, int frame,
                const PointCloudOptions& options) {
  const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, options.max_distance);
  const double weight = PointWeight(kComparedSigma, options.voxel_size);
  const double cost = CloudEquations(body, state, frame, cloud, matches, weight, std::nullopt, options).Cost();
  const double of_a_far_point = 0.5 * HuberValue(std::pow(weight * options.max_distance, 2), PointHuber(options));
  return cost + of_a_far_point * (cloud.size() - static_cast<double>(matches.size()));
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
