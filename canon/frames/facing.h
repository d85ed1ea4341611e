#pragma once

#include "canon/options.h"
#include "core/motion/clip.h"

namespace mocurate {

/// What the heading was read from; kept with the clip, since the two rules differ away from upright.
enum class YawSource { kHipAxis, kForwardAxis };

struct Heading {
  double yaw = 0.0;  ///< radians about +y, from canonical facing (+z) to the person's
  YawSource source = YawSource::kHipAxis;
  double horizontal = 1.0;  ///< length of the horizontal part of the axis used, 1 for upright
};

/// Heading of a left axis (unit, world): yaw = atan2(-left.z, left.x); when its horizontal part is shorter than
/// `min_horizontal`, that of the forward axis: atan2(forward.x, forward.z). [multiact.md B.3, B.4]
Heading HeadingOfAxes(const Vector3d& left, const Vector3d& forward, double min_horizontal);

/// Heading of one frame. With rotations the axes turn with the root (for SMPL: columns 0 and 2 of its matrix); joints
/// only: right to left hip (else shoulder), and that crossed with hips-to-neck. Error kInconsistent if the skeleton
/// names neither hips nor shoulders.
Expected<Heading> HeadingOfFrame(const Motion& motion, int frame, double min_horizontal);

/// Moves the clip so that the anchor frame's root is at the origin and faces +z: x -> Ry(-yaw) (x - x_anchor). Acts on
/// all fields; canonical_from_source keeps what undoing needs.
Expected<Heading> FaceFront(const FacingOptions& options, Clip& clip);

}  // namespace mocurate
