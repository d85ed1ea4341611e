#pragma once

#include <ceres/sized_cost_function.h>

#include "core/geometry/rotation.h"

namespace mocurate {

/// Prior of a joint's rotation about the rest pose; determines what no evidence does (twist of straight limbs,
/// unobserved joints).
/// Residual: r = w / sigma, 3 rows, sigma in radians: unitless.
/// Blocks: rotation vector[3] (parent_from_joint). Not for the root.
/// Jacobian: I / sigma.
/// Degenerate: none.
/// Source: zero-mean Gaussian prior.
class RestPriorCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  explicit RestPriorCost(double sigma) : weight_(1.0 / sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Vector3d>(residuals).noalias() = weight_ * Eigen::Map<const Vector3d>(parameters[0]);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Matrix3d>(jacobians[0]).noalias() = weight_ * Matrix3d::Identity();
    }
    return true;
  }

 private:
  double weight_;
};

}  // namespace mocurate
