#include "canon/frames/facing.h"

#include <cmath>

#include "core/motion/operations.h"

namespace mocurate {
namespace {

struct BodyAxes {
  Vector3d left = Vector3d::UnitX();
  Vector3d forward = Vector3d::UnitZ();
};

/// Rest-pose left axis in the root's frame: right to left hip, else canonical left.
Vector3d RestLeft(const Skeleton& skeleton) {
  const auto hips = skeleton.Hips();
  if (!hips) return Vector3d::UnitX();
  const Joint& left = skeleton.joints[(*hips)[0]];
  const Joint& right = skeleton.joints[(*hips)[1]];
  if (left.parent != 0 || right.parent != 0) return Vector3d::UnitX();
  const Vector3d axis = left.rest_offset - right.rest_offset;
  return axis.norm() > 1e-9 ? Vector3d(axis.normalized()) : Vector3d::UnitX();
}

Expected<BodyAxes> AxesFromJoints(const Motion& motion, int frame) {
  const Skeleton& skeleton = *motion.skeleton;
  auto pair = skeleton.Hips();
  if (!pair) pair = skeleton.Shoulders();
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
    const auto hips = skeleton.Hips();
    const Vector3d base =
        hips ? Vector3d(0.5 * (motion.joints.at(frame, (*hips)[0]) + motion.joints.at(frame, (*hips)[1])))
             : Vector3d(motion.joints.at(frame, 0));
    const Vector3d trunk = motion.joints.at(frame, *neck) - base;
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
  if (!motion.joints_only()) {
    const Quaterniond& root = motion.rotation_at(frame, 0);
    const Vector3d rest_left = RestLeft(*motion.skeleton);
    const Vector3d rest_forward = rest_left.cross(Vector3d::UnitY());
    return HeadingOfAxes(root * rest_left, root * rest_forward, min_horizontal);
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
