#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <optional>
#include "fitting/clouds/cloud_match.h"
#include "fitting/options.h"
#include "fitting/solver/pose_update.h"

namespace mocurate {

/// The costs of CloudEquations as a Ceres problem: one frame of matched points over the memory of a PoseState.
class CloudProblem {
 public:
  CloudProblem(const CapsuleBody& body, PoseState& state, const FrameTerms& terms, const PointCloudOptions& options);

  ceres::Problem& problem() { return problem_; }

 private:
  void AddPriors(const PoseGaussian* pose, const PointCloudOptions& options);
  void AddStep(const FixedNeighbourFrame& neighbour, const PointCloudOptions& options);

  const CapsuleBody& body_;
  PoseState& state_;
  const int frame_;
  PoseUpdate update_;
  ceres::HuberLoss point_loss_;
  ceres::HuberLoss joint_loss_;
  ceres::Problem problem_;
};

}  // namespace mocurate
