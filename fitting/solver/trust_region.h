#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace mocurate {

/// Levenberg-Marquardt damping and its update by the gain ratio, as in Ceres: Nielsen 1999, section 2.
class TrustRegion {
 public:
  Eigen::VectorXd Damping(const Eigen::VectorXd& diagonal) const {
    return diagonal.cwiseMax(kSmallestDiagonal * diagonal.maxCoeff()) / radius_;
  }
  /// `gain`: decrease of the cost over the predicted decrease of the quadratic model.
  void Accept(double gain) {
    radius_ = std::min(radius_ / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)), kLargestRadius);
    shrink_ = 2.0;
  }
  void Reject() {
    radius_ /= shrink_;
    shrink_ *= 2.0;
  }
  bool exhausted() const { return radius_ < kSmallestRadius; }

  /// Ratio of decrease to prediction of an accepted step. Source: Ceres Solver, min_relative_decrease
  static constexpr double kSmallestGain = 1e-3;

 private:
  static constexpr double kSmallestDiagonal = 1e-12;  ///< share of the largest diagonal element (numerical)
  /// Number, radius of the trust region. Source: Ceres Solver, max_trust_region_radius
  static constexpr double kLargestRadius = 1e16;
  /// Number, likewise. Source: Ceres Solver, min_trust_region_radius
  static constexpr double kSmallestRadius = 1e-32;
  double radius_ = 1e4;
  double shrink_ = 2.0;
};

}  // namespace mocurate
