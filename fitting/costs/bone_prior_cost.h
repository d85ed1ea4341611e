#pragma once

#include <ceres/sized_cost_function.h>

namespace mocurate {

/// Prior of a free bone's length.
/// Residual: r = (b - prior) / sigma, 1 row, both in metres: unitless.
/// Blocks: bone_length[1].
/// Jacobian: 1 / sigma.
/// Degenerate: none.
/// Source: Gaussian prior around the robust estimate or the rest skeleton.
class BonePriorCost final : public ceres::SizedCostFunction<1, 1> {
 public:
  BonePriorCost(double prior, double sigma) : prior_(prior), weight_(1.0 / sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residuals[0] = weight_ * (parameters[0][0] - prior_);
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = weight_;
    return true;
  }

 private:
  double prior_;
  double weight_;
};

}  // namespace mocurate
