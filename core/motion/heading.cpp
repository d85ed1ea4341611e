#include "core/motion/heading.h"

#include <cmath>

#include "core/base/pi.h"
#include "core/motion/limbs.h"

namespace mocurate {
namespace {

/// Columns left, up, forward: left as it is, up and forward made orthogonal to it.
Matrix3d AxesOf(const Vector3d& left, const Vector3d& up) {
  Vector3d forward = left.cross(up);
  forward = forward.norm() > 1e-9 ? Vector3d(forward.normalized()) : Vector3d(left.unitOrthogonal());
  Matrix3d axes;
  axes << left, forward.cross(left), forward;
  return axes;
}

Expected<Matrix3d> AxesFromJoints(const Motion& motion, int frame) {
  const Skeleton& skeleton = *motion.skeleton;
  const auto pair = HipsOrShoulders(skeleton);
  if (!pair) {
    return Fail(ErrorCode::kInconsistent, "skeleton '" + skeleton.name + "' names neither hips nor shoulders",
                "heading",
                "name the mirrored hip joints left_hip and right_hip, or do not rotate clips by their heading "
                "(canon.facing.rule: origin)");
  }
  const Vector3d left_joint = motion.joints.at(frame, (*pair)[0]);
  const Vector3d right_joint = motion.joints.at(frame, (*pair)[1]);
  Vector3d left = left_joint - right_joint;
  left = left.norm() > 1e-9 ? Vector3d(left.normalized()) : Vector3d(Vector3d::UnitX());
  Vector3d up = Vector3d::UnitY();
  if (const auto neck = skeleton.FindJoint("neck")) {
    const Vector3d trunk = Vector3d(motion.joints.at(frame, *neck)) - 0.5 * (left_joint + right_joint);
    if (trunk.norm() > 1e-6) up = trunk.normalized();
  }
  return AxesOf(left, up);
}

}  // namespace

std::optional<std::array<int, 2>> HipsOrShoulders(const Skeleton& skeleton) {
  if (const auto named = skeleton.Hips()) return named;
  const Limbs limbs = LimbsOf(skeleton);
  for (const std::array<Limb, 2>* pair : {&limbs.leg, &limbs.arm}) {
    const int left = (*pair)[0].root, right = (*pair)[1].root;
    if (left >= 0 && right >= 0 && left != right) return std::array<int, 2>{left, right};
  }
  return std::nullopt;
}

std::optional<Vector3d> RestLeftAxis(const Skeleton& skeleton) {
  const auto hips = HipsOrShoulders(skeleton);
  if (!hips) return std::nullopt;
  const Joint& left = skeleton.joints[(*hips)[0]];
  const Joint& right = skeleton.joints[(*hips)[1]];
  if (left.parent != 0 || right.parent != 0) return std::nullopt;
  const Vector3d axis = left.rest_offset - right.rest_offset;
  if (axis.norm() < 1e-9) return std::nullopt;
  return Vector3d(axis.normalized());
}

Matrix3d RestAxes(const Skeleton& skeleton) {
  const auto left = RestLeftAxis(skeleton);
  return left ? AxesOf(*left, Vector3d::UnitY()) : Matrix3d(Matrix3d::Identity());
}

const char* Name(YawSource source) {
  static constexpr const char* kNames[] = {"hip_axis", "forward_axis", "twist"};
  return kNames[static_cast<std::size_t>(source)];
}

Expected<Matrix3d> BodyAxes(const Motion& motion, int frame) {
  if (motion.joints_only() || !RestLeftAxis(*motion.skeleton)) return AxesFromJoints(motion, frame);
  return Matrix3d(motion.rotation_at(frame, 0) * RestAxes(*motion.skeleton));
}

Heading HeadingOfAxes(const Matrix3d& axes, HeadingRule rule, double min_horizontal) {
  const Vector3d left = axes.col(0), forward = axes.col(2);
  Heading heading;
  if (rule == HeadingRule::kTwist) {
    const Quaterniond q(axes);
    heading.source = YawSource::kTwist;
    heading.horizontal = std::hypot(q.w(), q.y());
    heading.yaw = std::remainder(2.0 * std::atan2(q.y(), q.w()), 2.0 * kPi);
    return heading;
  }
  heading.horizontal = std::hypot(left.x(), left.z());
  heading.yaw = std::atan2(-left.z(), left.x());
  if (rule == HeadingRule::kEuler || heading.horizontal >= min_horizontal) return heading;
  heading.source = YawSource::kForwardAxis;
  heading.horizontal = std::hypot(forward.x(), forward.z());
  heading.yaw = std::atan2(forward.x(), forward.z());
  return heading;
}

RigidTransform FacingFront(const Motion& motion, int frame) {
  const Heading heading =
      HeadingOfAxes(motion.rotation_at(frame, 0) * RestAxes(*motion.skeleton), HeadingRule::kHips, kLeastHorizontal);
  RigidTransform canonical_from_world;
  canonical_from_world.rotation = Quaterniond(Eigen::AngleAxisd(-heading.yaw, Vector3d::UnitY()));
  canonical_from_world.translation =
      -(canonical_from_world.rotation * motion.root_translation[static_cast<std::size_t>(frame)]);
  return canonical_from_world;
}

}  // namespace mocurate
