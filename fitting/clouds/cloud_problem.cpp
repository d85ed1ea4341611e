#include "fitting/clouds/cloud_problem.h"

#include <cmath>

#include "fitting/clouds/capsule_distance_cost.h"
#include "fitting/clouds/cloud_equations.h"
#include "fitting/costs/joint_limit_cost.h"
#include "fitting/costs/joint_velocity_cost.h"
#include "fitting/costs/rest_prior_cost.h"
#include "fitting/costs/rotation_smoothness_cost.h"

namespace mocurate {
CloudProblem::CloudProblem(const FleshBody& body, PoseState& state, const CloudFrames& frames, double sigma,
                           const PointCloudOptions& options)
    : body_(body),
      state_(state),
      frames_(frames),
      options_(options),
      weight_(PointWeight(sigma, options.voxel_size)),
      rest_spreads_(RestSpreads(*body.skeleton, options.rest_spread)),
      update_(state, frames.since_previous_s ? frames.begin - 1 : frames.begin, frames.end),
      loss_(PointHuber(options)),
      problem_(PoseProblemOptions(update_)) {}

void CloudProblem::AddFrame(int frame, const FusedCloud& cloud, const std::vector<CloudMatch>& matches) {
  for (const CloudMatch& match : matches) {
    auto* cost =
        new CapsuleDistanceCost(state_, frame, body_.capsules[match.capsule], cloud.points.col(match.point), weight_);
    problem_.AddResidualBlock(cost, &loss_, cost->Blocks(state_));
  }
  for (int j = 1; j < state_.joints(); ++j) {
    if (!state_.active(j)) continue;
    problem_.AddResidualBlock(new RestPriorCost(rest_spreads_[j]), nullptr, state_.rotation(frame, j));
    const auto& limits = body_.skeleton->joints[j].limits;
    if (!limits) continue;
    problem_.AddResidualBlock(new JointLimitCost(*limits, kCloudLimitSpread), nullptr, state_.rotation(frame, j));
  }
}

void CloudProblem::AddStep() {
  const int previous = frames_.begin - 1;
  const double root_of_time = std::sqrt(frames_.since_previous_s.value_or(0.0));
  const double turn_weight = 1.0 / (options_.rotation_walk * root_of_time);
  for (int j = 0; j < state_.joints(); ++j) {
    if (!state_.active(j)) continue;
    problem_.AddResidualBlock(new RotationSmoothnessCost(state_, previous, j, turn_weight), nullptr,
                              state_.rotation(previous, j), state_.rotation(previous + 1, j));
    problem_.SetParameterBlockConstant(state_.rotation(previous, j));
  }
  const double move_weight = 1.0 / (options_.velocity_walk * root_of_time);
  auto* cost = new JointVelocityCost(state_, previous, 0, move_weight, false);
  problem_.AddResidualBlock(cost, nullptr, cost->Blocks(state_));
  problem_.SetParameterBlockConstant(state_.translation(previous));
}

}  // namespace mocurate
