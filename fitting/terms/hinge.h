#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/geometry/rotation.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Sine of the angle to which knees and elbows hyperextend without cost.
inline constexpr double kFreeHyperextension = 0.2;

/// A joint that carries one bone and bends far one way only (HingeAxis): a knee or elbow. The bend therefore determines
/// the twist of the thigh or upper arm; the twist of the shin or forearm itself is free.
/// Source: hinge of one degree of freedom; the carrying angle (5 to 15 degrees at elbows) is within its sigma.
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
/// Degenerate: beyond a right angle, the second does not change its sign as the limb bends on.
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

}  // namespace mocurate
