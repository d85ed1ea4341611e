#include "fitting/clouds/capsule_fit.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "fitting/clouds/cloud_equations.h"
#include "fitting/clouds/cloud_problem.h"
#include "fitting/costs/huber.h"
#include "fitting/solver/one_thread.h"

namespace mocurate {
namespace {

constexpr double kRise = 1e-3;     ///< of the cost, that a new matching may bring (numerical)
constexpr int kSigmaRounds = 2;    ///< of a sigma that is measured: at the start and at the minimum (numerical)
constexpr int kWideMatchings = 4;  ///< matchings with a widened distance limit (numerical)
constexpr int kSolverSteps = 4;    ///< steps between two matchings (numerical)
constexpr double kRelativeTolerance = 1e-4;  ///< relative change of the cost that ends a solve (numerical)

ceres::Solver::Options DenseSolverOptions() {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.num_threads = 1;
  solver.max_num_iterations = kSolverSteps;
  solver.function_tolerance = kRelativeTolerance;
  solver.logging_type = ceres::SILENT;
  return solver;
}

std::vector<Vector3d> JointsOfState(const PoseState& state, int frame) {
  std::vector<Vector3d> joints;
  for (int j = 0; j < state.joints(); ++j) joints.push_back(state.position(frame, j));
  return joints;
}

double MeanMove(const std::vector<Vector3d>& before, const std::vector<Vector3d>& after) {
  double sum = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) sum += (after[i] - before[i]).norm();
  return sum / static_cast<double>(before.size());
}

/// Factor on the distance limit: from the first matching's down to 1 over a few matchings.
double Widening(double first, int iteration) {
  return 1.0 + (first - 1.0) * std::max(0.0, 1.0 - static_cast<double>(iteration) / kWideMatchings);
}

Expected<CloudSolution> SolveCapsulesWithCeres(const CapsuleBody& body, const FrameTerms& terms, PoseState& state,
                                               const PointCloudOptions& options) {
  CloudProblem problem(body, state, terms, options);
  ceres::Solver::Summary summary;
  const OneThread one_thread;
  ceres::Solve(DenseSolverOptions(), &problem.problem(), &summary);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kInconsistent, "the solver failed: " + summary.message,
                "frame " + std::to_string(terms.frame));
  }
  return CloudSolution{summary.initial_cost, summary.final_cost};
}

Expected<CloudSolution> SolveDense(const CapsuleBody& body, const FrameTerms& terms, PoseState& state,
                                   const PointCloudOptions& options) {
  CloudEquations equations(body, state, terms, options);
  return SolveCloudEquations(equations, kSolverSteps, kRelativeTolerance);
}

double SigmaOf(const std::vector<CloudMatch>& matches) {
  std::vector<double> distances;
  for (const CloudMatch& match : matches) distances.push_back(match.distance);
  return RobustSigma(std::move(distances));
}

/// Cost of the points that are not matched, each at the limit of the distance.
double CostOfUnmatched(const FrameTerms& terms, const PointCloudOptions& options) {
  const double of_one = 0.5 * HuberValue(std::pow(terms.weight * options.max_distance, 2), terms.huber);
  return of_one * (terms.cloud.size() - static_cast<double>(terms.matches.size()));
}

}  // namespace

Expected<CapsuleFitOutcome> FitCloudFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                          PoseState& state, const PointCloudOptions& options) {
  CapsuleFitOutcome outcome;
  const int frame = fit.frame;
  for (const FixedNeighbourFrame& neighbour : fit.held)
    state.Update(frame + neighbour.step, frame + neighbour.step + 1, true);
  const double share = fit.point_weight * PatchShare(options);
  const auto solve = options.solver == TrackSolver::kBanded ? SolveDense : SolveCapsulesWithCeres;
  double sigma = fit.sigma;
  const int rounds = fit.sigma > 0.0 ? 1 : kSigmaRounds;
  for (int round = 0; round < rounds; ++round) {
    outcome.converged = false;
    double cost = std::numeric_limits<double>::infinity();  // at the matching before, of the same distance limit
    std::vector<double> pose;                               // there
    for (int i = 0; outcome.iterations < fit.iterations && !outcome.converged; ++i) {
      state.Update(frame, frame + 1, false);
      const double widening = round == 0 ? Widening(fit.widening, i) : 1.0;
      const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, widening * options.max_distance);
      outcome.sigma = SigmaOf(matches);
      // Far starts: points weigh by how far they still are.
      if (widening > 1.0 || (fit.sigma == 0.0 && i == 0)) sigma = outcome.sigma;
      if (widening == 1.0 && fit.sigma > 0.0) sigma = fit.sigma;
      const FrameTerms terms{frame,    cloud,      matches, share / sigma, share * options.huber_sigmas,
                             fit.held, fit.joints, fit.pose};
      const std::vector<Vector3d> before = JointsOfState(state, frame);
      const std::vector<double> here = state.FrameParameters(frame);
      const auto solution = solve(body, terms, state, options);
      if (!solution) return Forward(solution);
      const double next = solution->initial_cost + CostOfUnmatched(terms, options);
      if (widening == 1.0 && next > (1.0 + kRise) * cost) {
        state.SetFrameParameters(frame, pose);
        state.Update(frame, frame + 1, false);
        outcome.converged = true;
        break;
      }
      if (widening == 1.0) cost = next;
      pose = here;
      if (outcome.iterations == 0) outcome.initial_cost = solution->initial_cost;
      outcome.final_cost = solution->final_cost;
      ++outcome.iterations;
      state.Update(frame, frame + 1, false);
      outcome.moved = MeanMove(before, JointsOfState(state, frame));
      outcome.converged = widening == 1.0 && outcome.moved < kSettled;
    }
  }
  return outcome;
}

double PoseCost(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit, PoseState& state,
                const PointCloudOptions& options) {
  const std::vector<CloudMatch> matches = MatchPoints(body, state, fit.frame, cloud, options.max_distance);
  const double share = fit.point_weight * PatchShare(options);
  const FrameTerms terms{fit.frame, cloud,      matches, share / fit.sigma, share * options.huber_sigmas,
                         fit.held,  fit.joints, fit.pose};
  return CloudEquations(body, state, terms, options).Cost() + CostOfUnmatched(terms, options);
}

double MeanDistance(const CapsuleBody& body, const FusedCloud& cloud, const PoseState& state, int frame,
                    double max_distance) {
  if (cloud.size() == 0) return 0.0;
  double sum = 0.0;
  const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, max_distance);
  for (const CloudMatch& match : matches) sum += std::abs(match.distance);
  return (sum + max_distance * (cloud.size() - static_cast<double>(matches.size()))) / cloud.size();
}

}  // namespace mocurate
