#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <optional>
#include <vector>

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

/// A point of a cloud lies on the surface of its capsule.
/// Residual: r = weight * (|point - q| - radius), q the nearest point of the capsule's axis; 1 row, weight in 1/m.
/// Blocks: root_translation[3]; rotation vector[3] of each active joint from the root down to the capsule's frame.
/// Jacobian, n = (point - q)/|point - q|: -weight n^T; -weight (n x (p_a - q))^T A_a (see PoseState). The place of q on
/// the axis contributes nothing: it is a minimum or stays at an end.
/// Degenerate: a point on the axis itself has no direction: zero Jacobian.
/// Source: articulated point-to-model registration; chain rule as in JointPositionCost.
class CapsuleDistanceCost final : public ceres::CostFunction {
 public:
  CapsuleDistanceCost(const PoseState& state, int frame, const BodyCapsule& capsule, const Vector3d& point,
                      double weight)
      : state_(state), frame_(frame), capsule_(capsule), point_(point), weight_(weight) {
    set_num_residuals(1);
    const std::size_t rotations = state.path(capsule.frame).size() + (state.active(capsule.frame) ? 1 : 0);
    mutable_parameter_block_sizes()->assign(1 + rotations, 3);
  }

  std::vector<double*> Blocks(PoseState& state) const {
    std::vector<double*> blocks{state.translation(frame_)};
    for (const int a : state.path(capsule_.frame)) blocks.push_back(state.rotation(frame_, a));
    if (state.active(capsule_.frame)) blocks.push_back(state.rotation(frame_, capsule_.frame));
    return blocks;
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const CapsuleEnds ends = EndsOf(capsule_, state_, frame_);
    const Vector3d nearest = ends.begin + PlaceOnAxis(ends, point_) * (ends.end - ends.begin);
    const Vector3d away = point_ - nearest;
    const double distance = away.norm();
    residuals[0] = weight_ * (distance - capsule_.radius);
    if (jacobians == nullptr) return true;
    const Vector3d pull = distance > 0.0 ? Vector3d(away * (-weight_ / distance)) : Vector3d(Vector3d::Zero());
    Differentiate(nearest, pull, jacobians);
    return true;
  }

 private:
  void Differentiate(const Vector3d& nearest, const Vector3d& pull, double** jacobians) const {
    std::size_t block = 0;
    if (jacobians[block] != nullptr) Eigen::Map<Vector3d>{jacobians[block]} = pull;
    ++block;
    for (const int a : state_.path(capsule_.frame)) SetRotationBlock(a, nearest, pull, jacobians[block++]);
    if (state_.active(capsule_.frame)) SetRotationBlock(capsule_.frame, nearest, pull, jacobians[block++]);
  }

  void SetRotationBlock(int joint, const Vector3d& nearest, const Vector3d& pull, double* jacobian) const {
    if (jacobian == nullptr) return;
    Eigen::Map<Vector3d>(jacobian).noalias() =
        state_.lever(frame_, joint).transpose() * pull.cross(state_.position(frame_, joint) - nearest);
  }

  const PoseState& state_;
  int frame_;
  const BodyCapsule& capsule_;
  Vector3d point_;
  double weight_;
};

}  // namespace mocurate
