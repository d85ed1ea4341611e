#pragma once

#include <ceres/sized_cost_function.h>

#include "core/geometry/rotation.h"

namespace mocurate {

/// A joint stays near its rest pose; decides what no evidence determines (twist of straight limbs, unseen joints).
/// Residual: r = w / spread, 3 rows, spread in radians: unitless.
/// Blocks: rotation vector[3] (parent_from_joint). Not for the root.
/// Jacobian: I / spread.
/// Degenerate: none.
/// Source: zero-mean Gaussian prior.
class RestPriorCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  explicit RestPriorCost(double spread) : weight_(1.0 / spread) {}

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
