#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "core/geometry/rotation.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Distance of a joint's world rotation from the recorded one.
/// Residual: r = weight * Log(target^T G_j), 3 rows; weight = confidence / sigma (1/rad), so r is unitless and white;
/// the caller sets the robust loss. Blocks: rotation vector[3] of each active joint from the root down to the joint
/// itself. Jacobian: weight * J_r^-1(Log(target^T G_j)) G_j^T A_a (see PoseState). Degenerate: at 180 degrees from the
/// target the residual's branch changes; the robust loss gives it a low weight. Source: Sola, Deray, Atchuthan 2018, A
/// micro Lie theory, sections II and IV.
class JointRotationCost final : public ceres::CostFunction {
 public:
  JointRotationCost(const PoseState& state, int frame, int joint, const Quaterniond& target, double weight)
      : state_(state),
        frame_(frame),
        joint_(joint),
        target_(target.toRotationMatrix()),
        weight_(weight),
        active_(state.path(joint)) {
    if (state.active(joint)) active_.push_back(joint);
    set_num_residuals(3);
    mutable_parameter_block_sizes()->assign(active_.size(), 3);
  }

  std::vector<double*> Blocks(PoseState& state) const {
    std::vector<double*> blocks;
    for (const int a : active_) blocks.push_back(state.rotation(frame_, a));
    return blocks;
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
    const Matrix3d& global = state_.global(frame_, joint_);
    const Vector3d away = LogMatrix(target_.transpose() * global);
    Eigen::Map<Vector3d>(residuals).noalias() = weight_ * away;
    if (jacobians == nullptr) return true;
    const Matrix3d whitened = weight_ * RightJacobianInverse(away) * global.transpose();
    for (std::size_t block = 0; block < active_.size(); ++block) {
      if (jacobians[block] == nullptr) continue;
      Block(jacobians[block]).noalias() = whitened * state_.lever(frame_, active_[block]);
    }
    return true;
  }

 private:
  const PoseState& state_;
  int frame_;
  int joint_;
  Matrix3d target_;
  double weight_;
  std::vector<int> active_;
};

}  // namespace mocurate
