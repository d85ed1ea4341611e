#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Distance of a joint from its tracked position.
/// Residual: r = W (joint_in_world - observed_in_world), 3 rows; W (3 x 3) with W'W the sample's information in 1 /
/// m^2, so that r is unitless and white; the caller sets the robust loss.
/// Blocks: root_translation[3]; rotation vector[3] of each active joint strictly above, root first.
/// Jacobian: W; -W Hat(p_j - p_a) A_a (see PoseState).
/// Degenerate: twist about a straight chain moves no joint: zero columns, determined by RestPriorCost.
/// Source: chain rule along the path to the root, as in inverse kinematics.
class JointPositionCost final : public ceres::CostFunction {
 public:
  JointPositionCost(const PoseState& state, int frame, int joint, const Vector3d& seen_in_world,
                    const Matrix3d& whitening)
      : state_(state), frame_(frame), joint_(joint), seen_in_world_(seen_in_world), whitening_(whitening) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->assign(1 + state.path(joint).size(), 3);
  }

  std::vector<double*> Blocks(PoseState& state) const {
    std::vector<double*> blocks{state.translation(frame_)};
    for (const int a : state.path(joint_)) blocks.push_back(state.rotation(frame_, a));
    return blocks;
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
    const Vector3d& position = state_.position(frame_, joint_);
    Eigen::Map<Vector3d>(residuals).noalias() = whitening_ * (position - seen_in_world_);
    if (jacobians == nullptr) return true;
    std::size_t block = 0;
    if (jacobians[block] != nullptr) Block{jacobians[block]} = whitening_;
    for (const int a : state_.path(joint_)) {
      if (jacobians[++block] == nullptr) continue;
      Block(jacobians[block]).noalias() =
          whitening_ * (Hat(state_.position(frame_, a) - position) * state_.lever(frame_, a));
    }
    return true;
  }

 private:
  const PoseState& state_;
  int frame_;
  int joint_;
  Vector3d seen_in_world_;
  Matrix3d whitening_;
};

}  // namespace mocurate
