#include "fitting/solver/track_problem.h"

#include <algorithm>
#include <cmath>

#include "fitting/costs/bone_prior_cost.h"
#include "fitting/costs/joint_limit_cost.h"
#include "fitting/costs/joint_position_cost.h"
#include "fitting/costs/joint_velocity_cost.h"
#include "fitting/costs/rest_prior_cost.h"
#include "fitting/costs/rotation_smoothness_cost.h"

namespace mocurate {
TrackProblem::TrackProblem(const SkeletonTracks& tracks, PoseState& state, const std::vector<double>& joint_sigma,
                           const std::vector<double>& bone_prior, Bones bones, const JointTrackOptions& options,
                           int begin, int end)
    : tracks_(tracks),
      state_(state),
      joint_sigma_(joint_sigma),
      options_(options),
      free_bones_(bones == Bones::kFree),
      update_(state, std::max(begin - 1, 0), end),
      loss_(options.huber_sigmas),
      problem_(PoseProblemOptions(update_)) {
  for (int f = begin; f < end; ++f) AddFrame(f);
  for (int f = std::max(begin - 1, 0); f + 1 < end; ++f) AddStep(f);
  if (free_bones_) AddBonePriors(bone_prior);
  if (begin == 0) return;
  std::vector<double*> held{state.translation(begin - 1)};
  for (int j = 0; j < state.joints(); ++j) held.push_back(state.rotation(begin - 1, j));
  for (double* block : held) {
    if (problem_.HasParameterBlock(block)) problem_.SetParameterBlockConstant(block);
  }
}

void TrackProblem::AddFrame(int frame) {
  for (int j = 0; j < state_.joints(); ++j) {
    if (tracks_.seen(frame, j)) {
      const double weight = tracks_.confidence_at(frame, j) / joint_sigma_[j];
      auto* cost = new JointPositionCost(state_, frame, j, tracks_.positions.at(frame, j), weight, free_bones_);
      problem_.AddResidualBlock(cost, &loss_, cost->Blocks(state_));
    }
    if (j == 0 || !state_.active(j)) continue;
    problem_.AddResidualBlock(new RestPriorCost(options_.rest_spread), nullptr, state_.rotation(frame, j));
    if (const auto& limits = tracks_.skeleton->joints[j].limits) {
      problem_.AddResidualBlock(new JointLimitCost(*limits, options_.limit_spread), nullptr, state_.rotation(frame, j));
    }
  }
}

void TrackProblem::AddStep(int frame) {
  const double dt = tracks_.time_s[frame + 1] - tracks_.time_s[frame];
  if (dt > options_.max_gap_s) return;
  const double rotation_weight = 1.0 / (options_.rotation_walk * std::sqrt(dt));
  const double velocity_weight = 1.0 / (options_.velocity_walk * std::sqrt(dt));
  for (int j = 0; j < state_.joints(); ++j) {
    if (state_.active(j)) {
      problem_.AddResidualBlock(new RotationSmoothnessCost(state_, frame, j, rotation_weight), nullptr,
                                state_.rotation(frame, j), state_.rotation(frame + 1, j));
    }
    auto* cost = new JointVelocityCost(state_, frame, j, velocity_weight, free_bones_);
    problem_.AddResidualBlock(cost, nullptr, cost->Blocks(state_));
  }
}

void TrackProblem::AddBonePriors(const std::vector<double>& bone_prior) {
  for (int j = 1; j < state_.joints(); ++j) {
    if (!problem_.HasParameterBlock(state_.bone(j))) continue;
    problem_.AddResidualBlock(new BonePriorCost(bone_prior[j], options_.bone_spread), nullptr, state_.bone(j));
  }
}

}  // namespace mocurate
