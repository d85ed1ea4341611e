#pragma once

#include <array>
#include <optional>

#include "core/geometry/rigid.h"
#include "core/motion/motion.h"

namespace mocurate {

/// Left and right hip, or shoulder where there are none; of a tree whose joints have other names, the first joints of
/// its legs or arms.
std::optional<std::array<int, 2>> HipsOrShoulders(const Skeleton& skeleton);

/// Directions of a person in the world, unit and orthogonal: columns left (+x of the canonical frame), up, forward.
/// With rotations they turn with the root (of SMPL: its matrix); joints only: right to left hip (else shoulder), hips
/// to neck. Error kInconsistent if the skeleton names neither hips nor shoulders.
Expected<Matrix3d> BodyAxes(const Motion& motion, int frame);

/// Rest-pose left axis in the root's frame, right to left hip; nothing when the hips do not hang from the root.
std::optional<Vector3d> RestLeftAxis(const Skeleton& skeleton);

/// Columns left, up, forward of a person in the rest pose, in the root's frame; the identity where the hips do not hang
/// from the root.
Matrix3d RestAxes(const Skeleton& skeleton);

/// How a heading is read (HeadingOfAxes).
enum class HeadingRule { kHips, kEuler, kTwist };

/// What a heading was read from; kept with the clip, since definitions differ away from upright.
enum class YawSource { kHipAxis, kForwardAxis, kTwist };
const char* Name(YawSource source);

struct Heading {
  double yaw = 0.0;  ///< radians about +y, from canonical facing (+z) to the person's
  YawSource source = YawSource::kHipAxis;
  double horizontal = 1.0;  ///< of the vector that gives yaw, 1 for upright; at 0 yaw is not defined
};

/// Yaw of body axes (columns left, up, forward), by `rule`:
///   kHips   atan2(-left.z, left.x); where its horizontal part is shorter than `min_horizontal`,
///           atan2(forward.x, forward.z) [multiact.md B.4]
///   kEuler  atan2(-left.z, left.x) always, as the released code has it: jumps where the hip axis passes the vertical
///           [multiact.md B.1, y-up form B.3]
///   kTwist  the turn about +y in R = Ry(yaw) S, S about a horizontal axis: 2 atan2(q.y, q.w). Continuous in every pose
///           but upside down
Heading HeadingOfAxes(const Matrix3d& axes, HeadingRule rule, double min_horizontal);

/// Length of the hip axis's horizontal part below which its yaw is ill-conditioned, cos 78 degrees [multiact.md B.4].
inline constexpr double kLeastHorizontal = 0.2;

/// Moves a frame of a motion with rotations to the origin, facing +z: canonical_from_world by the heading of the hips
/// and the root's place [multiact.md B.1, B.4].
RigidTransform FacingFront(const Motion& motion, int frame);

}  // namespace mocurate
