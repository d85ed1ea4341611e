#pragma once

#include <ceres/sized_cost_function.h>

#include "core/motion/skeleton.h"

namespace mocurate {

/// Soft limits of a joint's rotation.
/// Residual: r_i = max(0, w_i - max_i) / sigma - max(0, min_i - w_i) / sigma, 3 rows, radians over radians: unitless.
/// Blocks: rotation vector[3] (parent_from_joint).
/// Jacobian: diagonal, 1 / sigma beyond a limit, 0 inside.
/// Degenerate: at a limit itself the one-sided derivative of the inside (0) is given.
/// Source: hinge loss on the components of the rotation vector; exact for joints that rotate about one axis.
class JointLimitCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  JointLimitCost(const JointLimits& limits, double sigma) : limits_(limits), weight_(1.0 / sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Vector3d slope = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      const double w = parameters[0][i];
      const double beyond = w > limits_.max[i] ? w - limits_.max[i] : w < limits_.min[i] ? w - limits_.min[i] : 0.0;
      residuals[i] = weight_ * beyond;
      slope[i] = beyond == 0.0 ? 0.0 : weight_;
    }
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Matrix3d>(jacobians[0]).noalias() = Matrix3d(slope.asDiagonal());
    return true;
  }

 private:
  JointLimits limits_;
  double weight_;
};

}  // namespace mocurate
