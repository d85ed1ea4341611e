#pragma once

#include <ceres/sized_cost_function.h>

#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Process noise of a joint's rotation between a frame and the next.
/// Residual: r = weight * Log(R_frame^T R_next), 3 rows; weight = 1 / (q * sqrt(dt)) with the process noise q in rad
/// per sqrt(s): unitless, the same for any frame rate. Independent of the branch of either rotation vector. Blocks:
/// rotation vector[3] (parent_from_joint) of the frame, of the next frame. Jacobian: -weight * J_l^-1(d) J_r(w_frame);
/// weight * J_r^-1(d) J_r(w_next), d = Log(R_frame^T R_next), J_l^-1 = J_r^-T. Degenerate: a rotation of exactly pi
/// between two frames, where Log changes its branch; the cost is largest there. Source: random walk on SO(3); Sola et
/// al. 2018, eqs. 143-147.
class RotationSmoothnessCost final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  RotationSmoothnessCost(const PoseState& state, int frame, int joint, double weight)
      : state_(state), frame_(frame), joint_(joint), weight_(weight) {}

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
    const Vector3d difference = LogMatrix(state_.local(frame_, joint_).transpose() * state_.local(frame_ + 1, joint_));
    Eigen::Map<Vector3d>(residuals).noalias() = weight_ * difference;
    if (jacobians == nullptr) return true;
    const Matrix3d inverse = weight_ * RightJacobianInverse(difference);
    if (jacobians[0] != nullptr) {
      Block(jacobians[0]).noalias() = -inverse.transpose() * state_.right_jacobian(frame_, joint_);
    }
    if (jacobians[1] != nullptr) Block(jacobians[1]).noalias() = inverse * state_.right_jacobian(frame_ + 1, joint_);
    return true;
  }

 private:
  const PoseState& state_;
  int frame_;
  int joint_;
  double weight_;
};

}  // namespace mocurate
