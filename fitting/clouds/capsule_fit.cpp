#include "fitting/clouds/capsule_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "fitting/clouds/cloud_terms.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/solve.h"

namespace mocurate {
namespace {

constexpr double kRise = 1e-3;     ///< of the cost, that a new matching may bring (numerical)
constexpr int kSigmaRounds = 2;    ///< of a sigma that is measured: at the start and at the minimum (numerical)
constexpr int kWideMatchings = 4;  ///< matchings with a widened distance limit (numerical)
constexpr int kSolverSteps = 4;    ///< steps between two matchings (numerical)
constexpr double kPatch = 0.15;    ///< m; edge of a patch whose points share their errors
constexpr double kRelativeTolerance = 1e-4;  ///< relative change of the cost that ends a solve (numerical)

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

/// Cost of the points that are not matched, each at the limit of the distance.
double CostOfUnmatched(const SurfaceTerm& surface, const PointCloudOptions& options) {
  const double of_one = 0.5 * HuberValue(std::pow(surface.weight * options.max_distance, 2), surface.huber);
  return of_one * (static_cast<double>(surface.points->cols()) - static_cast<double>(surface.matches.size()));
}

}  // namespace

Expected<CapsuleFitOutcome> FitCloudFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                          PoseState& state, const PointCloudOptions& options) {
  CapsuleFitOutcome outcome;
  const int frame = fit.frame;
  for (const FixedNeighbourFrame& neighbour : fit.held)
    state.Update(frame + neighbour.step, frame + neighbour.step + 1, true);
  double sigma = fit.sigma;
  PoseTerms terms = CloudTerms(body, options);
  terms.frames = {TermsOfFit(body, cloud, fit, {}, 1.0, options)};
  SurfaceTerm& surface = terms.frames.front().surface;
  const double share = surface.weight;
  BlockTridiagonal memory;
  const SolveOptions solve{fit.solver, kRelativeTolerance, kSolverSteps, "fit of depth views", &memory};
  const int rounds = fit.sigma > 0.0 ? 1 : kSigmaRounds;
  for (int round = 0; round < rounds; ++round) {
    outcome.converged = false;
    double cost = std::numeric_limits<double>::infinity();  // at the matching before, of the same distance limit
    std::vector<double> pose;                               // there
    for (int i = 0; outcome.iterations < fit.iterations && !outcome.converged; ++i) {
      state.Update(frame, frame + 1, false);
      const double widening = round == 0 ? Widening(fit.widening, i) : 1.0;
      surface.matches = MatchPoints(body, state, frame, cloud, widening * options.max_distance);
      outcome.residual = RobustSigma(surface.matches);
      // Far starts: points weigh by how far they still are.
      if (widening > 1.0 || (fit.sigma == 0.0 && i == 0)) sigma = outcome.residual;
      if (widening == 1.0 && fit.sigma > 0.0) sigma = fit.sigma;
      surface.weight = share / sigma;
      const std::vector<Vector3d> before = JointsOfState(state, frame);
      const std::vector<double> here = state.FrameParameters(frame);
      const auto solution = Solve(terms, state, solve);
      if (!solution) return Forward(solution);
      outcome.sigma = sigma;
      const double next = solution->initial_cost + CostOfUnmatched(surface, options);
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
      outcome.moved = MeanMove(before, JointsOfState(state, frame));
      outcome.converged = widening == 1.0 && outcome.moved < kSettled;
    }
  }
  return outcome;
}

double PoseCost(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit, PoseState& state,
                const PointCloudOptions& options) {
  PoseTerms terms = CloudTerms(body, options);
  terms.frames = {TermsOfFit(body, cloud, fit, MatchPoints(body, state, fit.frame, cloud, options.max_distance),
                             fit.sigma, options)};
  return Cost(terms, state) + CostOfUnmatched(terms.frames.front().surface, options);
}

double MeanDistance(const CapsuleBody& body, const FusedCloud& cloud, const PoseState& state, int frame,
                    double max_distance) {
  if (cloud.size() == 0) return 0.0;
  double sum = 0.0;
  const std::vector<CloudMatch> matches = MatchPoints(body, state, frame, cloud, max_distance);
  for (const CloudMatch& match : matches) sum += std::abs(match.distance);
  return (sum + max_distance * (cloud.size() - static_cast<double>(matches.size()))) / cloud.size();
}

std::vector<double> PointCosts(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                               const PoseState& state, const PointCloudOptions& options) {
  const double share = fit.point_weight * PatchShare(cloud, options), weight = share / fit.sigma;
  const double huber = share * HuberSigmas(options.huber_share, 1);
  std::vector<double> costs(static_cast<std::size_t>(cloud.size()),
                            0.5 * HuberValue(Square(weight * options.max_distance), huber));
  for (const CloudMatch& match : MatchPoints(body, state, fit.frame, cloud, options.max_distance))
    costs[static_cast<std::size_t>(match.point)] = 0.5 * HuberValue(Square(weight * match.distance), huber);
  return costs;
}

CostDifference Compare(const FusedCloud& cloud, const std::vector<double>& costs, const std::vector<double>& other) {
  std::map<std::array<int, 3>, double> patches;
  for (int i = 0; i < cloud.size(); ++i) {
    const Eigen::Array3i patch = (cloud.points.col(i).array() / kPatch).floor().cast<int>();
    const auto at = static_cast<std::size_t>(i);
    patches[{patch[0], patch[1], patch[2]}] += costs[at] - other[at];
  }
  CostDifference difference;
  for (const auto& [patch, more] : patches) difference += {more, more * more};
  difference.variance -= Square(difference.sum) / std::max(1.0, static_cast<double>(patches.size()));
  return difference;
}

}  // namespace mocurate
