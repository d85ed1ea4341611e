#include "canon/frames/facing.h"

#include <array>
#include <cmath>
#include <optional>

#include "core/motion/limbs.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

struct BodyAxes {
  Vector3d left = Vector3d::UnitX();
  Vector3d forward = Vector3d::UnitZ();
};

/// Left and right hip, or shoulder where there are none. Of a tree that a file brings along, whose joints have other
/// names, the first joints of its legs or arms.
std::optional<std::array<int, 2>> HipsOf(const Skeleton& skeleton) {
  if (const auto named = skeleton.Hips()) return named;
  const Limbs limbs = LimbsOf(skeleton);
  for (const std::array<Limb, 2>* pair : {&limbs.leg, &limbs.arm}) {
    const int left = (*pair)[0].root, right = (*pair)[1].root;
    if (left >= 0 && right >= 0 && left != right) return std::array<int, 2>{left, right};
  }
  return std::nullopt;
}

/// Rest-pose left axis in the root's frame, right to left hip; nothing when the hips do not hang from the root.
std::optional<Vector3d> RestLeft(const Skeleton& skeleton) {
  const auto hips = HipsOf(skeleton);
  if (!hips) return std::nullopt;
  const Joint& left = skeleton.joints[(*hips)[0]];
  const Joint& right = skeleton.joints[(*hips)[1]];
  if (left.parent != 0 || right.parent != 0) return std::nullopt;
  const Vector3d axis = left.rest_offset - right.rest_offset;
  if (axis.norm() < 1e-9) return std::nullopt;
  return Vector3d(axis.normalized());
}

Expected<BodyAxes> AxesFromJoints(const Motion& motion, int frame) {
  const Skeleton& skeleton = *motion.skeleton;
  const auto pair = HipsOf(skeleton);
  if (!pair) {
    return Fail(ErrorCode::kInconsistent, "skeleton '" + skeleton.name + "' names neither hips nor shoulders",
                "canon.facing", "name the mirrored hip joints left_hip and right_hip, or set facing.rule: none");
  }
  const Vector3d left_joint = motion.joints.at(frame, (*pair)[0]);
  const Vector3d right_joint = motion.joints.at(frame, (*pair)[1]);
  BodyAxes axes;
  axes.left = (left_joint - right_joint).normalized();
  Vector3d up = Vector3d::UnitY();
  if (const auto neck = skeleton.FindJoint("neck")) {
    const Vector3d trunk = Vector3d(motion.joints.at(frame, *neck)) - 0.5 * (left_joint + right_joint);
    if (trunk.norm() > 1e-6) up = trunk.normalized();
  }
  const Vector3d forward = axes.left.cross(up);
  axes.forward = forward.norm() > 1e-9 ? Vector3d(forward.normalized()) : Vector3d::UnitZ();
  return axes;
}

}  // namespace

Heading HeadingOfAxes(const Vector3d& left, const Vector3d& forward, double min_horizontal) {
  Heading heading;
  heading.horizontal = std::hypot(left.x(), left.z());
  if (heading.horizontal >= min_horizontal) {
    heading.yaw = std::atan2(-left.z(), left.x());
    return heading;
  }
  heading.source = YawSource::kForwardAxis;
  heading.horizontal = std::hypot(forward.x(), forward.z());
  heading.yaw = std::atan2(forward.x(), forward.z());
  return heading;
}

Expected<Heading> HeadingOfFrame(const Motion& motion, int frame, double min_horizontal) {
  const auto rest_left = motion.joints_only() ? std::nullopt : RestLeft(*motion.skeleton);
  if (rest_left) {
    const Quaterniond& root = motion.rotation_at(frame, 0);
    return HeadingOfAxes(root * *rest_left, root * rest_left->cross(Vector3d::UnitY()), min_horizontal);
  }
  const auto axes = AxesFromJoints(motion, frame);
  if (!axes) return Forward(axes);
  return HeadingOfAxes(axes->left, axes->forward, min_horizontal);
}

Expected<Heading> FaceFront(const FacingOptions& options, Clip& clip) {
  if (!clip.motion || clip.motion->frame_count() == 0) {
    return Fail(ErrorCode::kInconsistent, "clip has no motion to canonicalise", clip.id(),
                "run the stage fitting first");
  }
  const Motion& motion = *clip.motion;
  const int anchor = options.anchor == Anchor::kFirst ? 0 : motion.frame_count() - 1;
  Heading heading;
  if (options.rule == FacingRule::kHips) {
    const auto found = HeadingOfFrame(motion, anchor, options.min_horizontal);
    if (!found) return Forward(found);
    heading = *found;
  }
  RigidTransform canonical_from_clip;
  canonical_from_clip.rotation = Quaterniond(Eigen::AngleAxisd(-heading.yaw, Vector3d::UnitY()));
  canonical_from_clip.translation = -(canonical_from_clip.rotation * Vector3d(motion.joints.at(anchor, 0)));
  Transform(canonical_from_clip, clip);
  return heading;
}

}  // namespace mocurate
