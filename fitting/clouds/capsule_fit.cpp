#include "fitting/clouds/capsule_fit.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/body/bone_capsules.h"
#include "core/motion/limbs.h"
#include "fitting/clouds/cloud_equations.h"
#include "fitting/clouds/cloud_problem.h"
#include "fitting/costs/huber.h"
#include "fitting/solver/one_thread.h"

namespace mocurate {
namespace {

/// m; mean joint movement at convergence, well below the error of the body (numerical).
constexpr double kSettled = 1e-3;
constexpr int kWideMatchings = 4;            ///< matchings with a widened distance limit (numerical)
constexpr int kSolverSteps = 4;              ///< steps between two matchings (numerical)
constexpr double kRelativeTolerance = 1e-4;  ///< relative change of the cost that ends a solve (numerical)
constexpr double kComparedSigma = 0.01;      ///< m; standard deviation for comparisons: error of a capsule body
constexpr double kAllowedOverlap = 0.05;     ///< m by which a thigh and the chest or an arm may overlap
constexpr int kPlacesOfLeg = 5;              ///< sampled points on each capsule of a leg (numerical)

/// The chest and all its descendants: neck, head and arms. (J)
std::vector<bool> UpperBody(const Skeleton& skeleton, const Limbs& limbs) {
  std::vector<bool> of_it(skeleton.joints.size(), false);
  if (limbs.chest < 1) return of_it;
  of_it[limbs.chest] = true;
  for (int j = limbs.chest + 1; j < skeleton.joint_count(); ++j) of_it[j] = of_it[skeleton.joints[j].parent];
  return of_it;
}

/// Cost of knees, shins and feet inside chest, head or arms. Where points do not show the legs, a fit would fold them
/// into the upper body to explain it a little better.
double LegsInUpperBody(const CapsuleBody& body, const PoseState& state, int frame) {
  const Limbs limbs = LimbsOf(*body.skeleton);
  const std::vector<bool> upper = UpperBody(*body.skeleton, limbs);
  std::vector<std::pair<CapsuleEnds, double>> above;  // and radius
  for (const BodyCapsule& capsule : body.capsules) {
    if (upper[capsule.frame]) above.emplace_back(EndsOf(capsule, state, frame), capsule.radius);
  }
  double cost = 0.0;
  for (const BodyCapsule& leg : body.capsules) {
    std::optional<double> beyond;  // m from the parent joint: the upper half of a thigh is free
    for (const Limb& limb : limbs.leg) {
      if (limb.known() && leg.frame == limb.root)
        beyond = 0.5 * (state.position(frame, limb.middle) - state.position(frame, limb.root)).norm();
      if (limb.known() && (leg.frame == limb.middle || leg.frame == limb.end)) beyond = 0.0;
    }
    if (!beyond) continue;
    const CapsuleEnds ends = EndsOf(leg, state, frame);
    double deepest = 0.0;
    for (int i = 0; i < kPlacesOfLeg; ++i) {
      const double at = static_cast<double>(i) / (kPlacesOfLeg - 1);
      const Vector3d place = (1.0 - at) * ends.begin + at * ends.end;
      if ((place - state.position(frame, leg.frame)).norm() < *beyond) continue;
      for (const auto& [segment, radius] : above)
        deepest =
            std::max(deepest, leg.radius - SignedDistance(segment.begin, segment.end, radius, place) - kAllowedOverlap);
    }
    cost += 0.5 * Square(deepest / kComparedSigma);
  }
  return cost;
}

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

}  // namespace

Expected<CapsuleFitOutcome> FitCloudFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                          PoseState& state, const PointCloudOptions& options) {
  CapsuleFitOutcome outcome;
  const int frame = fit.frame;
  for (const FixedNeighbourFrame& neighbour : fit.held)
    state.Update(frame + neighbour.step, frame + neighbour.step + 1, true);
  const double share = fit.point_weight * PatchShare(options);
  for (int i = 0; i < fit.iterations && !outcome.converged; ++i) {
    state.Update(frame, frame + 1, false);
    const double widening = Widening(fit.widening, i);
    const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, widening * options.max_distance);
    std::vector<double> distances;
    for (const CloudMatch& match : matches) distances.push_back(match.distance);
    outcome.sigma = RobustSigma(std::move(distances));
    const std::vector<Vector3d> before = JointsOfState(state, frame);
    const auto solve = options.solver == TrackSolver::kBanded ? SolveDense : SolveCapsulesWithCeres;
    const auto solution = solve(
        body,
        {frame, cloud, matches, share / outcome.sigma, share * options.huber_sigmas, fit.held, fit.joints, fit.pose},
        state, options);
    if (!solution) return Forward(solution);
    if (i == 0) outcome.initial_cost = solution->initial_cost;
    outcome.final_cost = solution->final_cost;
    ++outcome.iterations;
    state.Update(frame, frame + 1, false);
    outcome.moved = MeanMove(before, JointsOfState(state, frame));
    outcome.converged = widening == 1.0 && outcome.moved < kSettled;
  }
  return outcome;
}

double PoseCost(const CapsuleBody& body, const FusedCloud& cloud, PoseState& state, int frame,
                const PointCloudOptions& options) {
  const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, options.max_distance);
  const double share = PatchShare(options);
  const double weight = share / kComparedSigma;
  const double huber = share * options.huber_sigmas;
  const double cost = CloudEquations(body, state, {frame, cloud, matches, weight, huber, {}, {}}, options).Cost();
  const double of_a_far_point = 0.5 * HuberValue(std::pow(weight * options.max_distance, 2), huber);
  return cost + of_a_far_point * (cloud.size() - static_cast<double>(matches.size())) +
         LegsInUpperBody(body, state, frame);
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
