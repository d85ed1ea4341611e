#include "fitting/clouds/cloud_problem.h"

#include <algorithm>
#include <cmath>

#include "fitting/clouds/cloud_equations.h"
#include "fitting/costs/joint_limit_cost.h"
#include "fitting/costs/joint_position_cost.h"
#include "fitting/costs/joint_velocity_cost.h"
#include "fitting/costs/pose_gaussian_cost.h"
#include "fitting/costs/rest_prior_cost.h"
#include "fitting/costs/rotation_smoothness_cost.h"

namespace mocurate {
namespace {

int FirstOf(const FrameTerms& terms) {
  int first = terms.frame;
  for (const FixedNeighbourFrame& neighbour : terms.held) first = std::min(first, terms.frame + neighbour.step);
  return first;
}

int LastOf(const FrameTerms& terms) {
  int last = terms.frame;
  for (const FixedNeighbourFrame& neighbour : terms.held) last = std::max(last, terms.frame + neighbour.step);
  return last;
}

}  // namespace

CloudProblem::CloudProblem(const CapsuleBody& body, PoseState& state, const FrameTerms& terms,
                           const PointCloudOptions& options)
    : body_(body),
      state_(state),
      frame_(terms.frame),
      update_(state, FirstOf(terms), LastOf(terms) + 1),
      point_loss_(terms.huber),
      joint_loss_(options.huber_sigmas),
      problem_(PoseProblemOptions(update_)) {
  for (const CloudMatch& match : terms.matches) {
    auto* cost = new CapsuleDistanceCost(state_, frame_, body_.capsules[match.capsule],
                                         terms.cloud.points.col(match.point), terms.weight);
    problem_.AddResidualBlock(cost, &point_loss_, cost->Blocks(state_));
  }
  for (const JointObservation& seen : terms.joints) {
    auto* cost = new JointPositionCost(state_, frame_, seen.joint, seen.position, seen.whitening);
    problem_.AddResidualBlock(cost, &joint_loss_, cost->Blocks(state_));
  }
  AddPriors(terms.pose, options);
  if (terms.pose != nullptr) {
    auto* cost = new PoseGaussianCost(state_, frame_, *terms.pose);
    problem_.AddResidualBlock(cost, nullptr, cost->Blocks(state_));
  }
  for (const FixedNeighbourFrame& neighbour : terms.held) AddStep(neighbour, options);
}

void CloudProblem::AddPriors(const PoseGaussian* pose, const PointCloudOptions& options) {
  const std::vector<RestAndLimits> priors = PriorsInClouds(*body_.skeleton, pose, options);
  for (int j = 1; j < state_.joints(); ++j) {
    const RestAndLimits& prior = priors[static_cast<std::size_t>(j)];
    if (!state_.active(j)) continue;
    if (prior.rest > 0.0) {
      const double sigma = 1.0 / std::sqrt(prior.rest);
      problem_.AddResidualBlock(new RestPriorCost(sigma), nullptr, state_.rotation(frame_, j));
    }
    if (prior.limits == nullptr) continue;
    problem_.AddResidualBlock(new JointLimitCost(*prior.limits, kCloudLimitSigma), nullptr, state_.rotation(frame_, j));
  }
}

void CloudProblem::AddStep(const FixedNeighbourFrame& neighbour, const PointCloudOptions& options) {
  const int other = frame_ + neighbour.step;
  const int first = std::min(frame_, other);
  const double root_of_time = std::sqrt(neighbour.seconds);
  const double rotation_term_weight = 1.0 / (options.rotation_process_noise * root_of_time);
  for (int j = 0; j < state_.joints(); ++j) {
    if (!state_.active(j)) continue;
    problem_.AddResidualBlock(new RotationSmoothnessCost(state_, first, j, rotation_term_weight), nullptr,
                              state_.rotation(first, j), state_.rotation(first + 1, j));
    problem_.SetParameterBlockConstant(state_.rotation(other, j));
  }
  const double move_weight = 1.0 / (options.velocity_process_noise * root_of_time);
  auto* cost = new JointVelocityCost(state_, first, 0, move_weight);
  problem_.AddResidualBlock(cost, nullptr, cost->Blocks(state_));
  problem_.SetParameterBlockConstant(state_.translation(other));
}

}  // namespace mocurate
