#pragma once

#include <ceres/sized_cost_function.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "core/geometry/rotation.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Sine of the angle to which knees and elbows hyperextend without cost.
inline constexpr double kFreeHyperextension = 0.2;

/// A joint that carries one bone and bends far one way only (HingeAxis).
struct Hinge {
  int axis = 0;                          ///< of the joint's frame in the rest pose
  Vector3d bone = Vector3d::Zero();      ///< direction of the bone at rest, unit
  Vector3d forwards = Vector3d::Zero();  ///< direction in which the end of the bone moves as the joint begins to bend
};

/// Of each joint; empty: not a hinge. (J)
inline std::vector<std::optional<Hinge>> HingesOf(const Skeleton& skeleton) {
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<std::optional<Hinge>> hinges(skeleton.joints.size());
  for (std::size_t j = 0; j < hinges.size(); ++j) {
    if (!skeleton.joints[j].limits || children[j].size() != 1) continue;
    const JointLimits& limits = *skeleton.joints[j].limits;
    const auto axis = HingeAxis(limits);
    if (!axis) continue;
    Hinge hinge;
    hinge.axis = *axis;
    hinge.bone = skeleton.joints[children[j].front()].rest_offset.stableNormalized();
    const double way = limits.max[*axis] > -limits.min[*axis] ? 1.0 : -1.0;
    hinge.forwards = way * Vector3d::Unit(*axis).cross(hinge.bone);
    hinges[j] = hinge;
  }
  return hinges;
}

/// Violation of a joint's hinge: the sine of the angle between bone and hinge plane, and hyperextension beyond
/// kFreeHyperextension (negative, as a sine); 0 inside.
inline Eigen::Vector2d OffHinge(const Hinge& hinge, const Matrix3d& parent_from_joint) {
  const Vector3d bone = parent_from_joint * hinge.bone;
  const double bend = hinge.forwards.dot(bone);
  return {bone[hinge.axis] - hinge.bone[hinge.axis], std::min(0.0, bend + kFreeHyperextension)};
}

/// Derivatives of both by the rotation vector.
inline Eigen::Matrix<double, 2, 3> OffHingeSlopes(const Hinge& hinge, const Matrix3d& parent_from_joint,
                                                  const Vector3d& rotation_vector) {
  const Matrix3d moved = -parent_from_joint * Hat(hinge.bone) * RightJacobian(rotation_vector);
  Eigen::Matrix<double, 2, 3> slopes;
  slopes.row(0) = moved.row(hinge.axis);
  slopes.row(1).setZero();
  if (OffHinge(hinge, parent_from_joint)[1] < 0.0) slopes.row(1) = hinge.forwards.transpose() * moved;
  return slopes;
}

/// A knee or elbow bends about its hinge, in one direction. The bend therefore determines the twist of the thigh or
/// upper arm. The twist of the shin or forearm itself has no cost.
/// Residuals: r_0 = s / sigma, r_1 = min(0, b + e) / sigma, 2 rows; s sine of the angle out of the plane, b sine of the
/// bend, e kFreeHyperextension: unitless.
/// Blocks: rotation vector[3] (parent_from_joint).
/// Jacobian: rows h^T and f^T of -R [bone]x J_r(w), over sigma; h hinge, f forwards; the second 0 inside.
/// Degenerate: beyond a right angle, the second residual does not change its sign as the limb bends on.
/// Source: hinge of one degree of freedom; the carrying angle (5 to 15 degrees at elbows) is within sigma.
class HingeCost final : public ceres::SizedCostFunction<2, 3> {
 public:
  HingeCost(const Hinge& hinge, double sigma) : hinge_(hinge), weight_(1.0 / sigma) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Vector3d w = Eigen::Map<const Vector3d>(parameters[0]);
    const Matrix3d local = ExpMatrix(w);
    Eigen::Map<Eigen::Vector2d>(residuals).noalias() = weight_ * OffHinge(hinge_, local);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>(jacobians[0]).noalias() =
          weight_ * OffHingeSlopes(hinge_, local, w);
    }
    return true;
  }

 private:
  Hinge hinge_;
  double weight_;
};

}  // namespace mocurate
