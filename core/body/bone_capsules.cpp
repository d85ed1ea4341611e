#include "core/body/bone_capsules.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mocurate {
BoneCapsules BoneCapsules::Make(SkeletonPtr skeleton, double radius_scale) {
  BoneCapsules body;
  for (int j = 1; j < skeleton->joint_count(); ++j) {
    const Joint& joint = skeleton->joints[j];
    if (joint.radius * radius_scale > 0.0) body.capsules.push_back({j, joint.parent, joint.radius * radius_scale});
  }
  body.skeleton = std::move(skeleton);
  return body;
}

CapsulePoint ClosestOnCapsule(const Vector3d& parent_end, const Vector3d& joint_end, double radius,
                              const Vector3d& point) {
  const Vector3d bone = joint_end - parent_end;
  const double square = bone.squaredNorm();
  CapsulePoint closest;
  if (square > 0.0) closest.fraction = std::clamp((point - parent_end).dot(bone) / square, 0.0, 1.0);
  const Vector3d on_bone = parent_end + closest.fraction * bone;
  const Vector3d away = point - on_bone;
  const double distance = away.norm();
  // On the bone every direction around it is as near as any other.
  closest.normal =
      distance > 0.0 ? Vector3d(away / distance) : SwingBetween(Vector3d::UnitZ(), bone) * Vector3d::UnitX();
  closest.distance = distance - radius;
  closest.point = on_bone + radius * closest.normal;
  return closest;
}

double SignedDistance(const Vector3d& parent_end, const Vector3d& joint_end, double radius, const Vector3d& point) {
  const Vector3d bone = joint_end - parent_end;
  const double square = bone.squaredNorm();
  const double fraction = square > 0.0 ? std::clamp((point - parent_end).dot(bone) / square, 0.0, 1.0) : 0.0;
  return (point - parent_end - fraction * bone).norm() - radius;
}

std::optional<BodyPoint> ClosestOnBody(const BoneCapsules& body, const Vector3d* joints, const Vector3d& point) {
  int nearest = -1;
  double least = 0.0;
  for (std::size_t i = 0; i < body.capsules.size(); ++i) {
    const Capsule& capsule = body.capsules[i];
    const double distance = SignedDistance(joints[capsule.parent], joints[capsule.joint], capsule.radius, point);
    if (nearest >= 0 && distance >= least) continue;
    nearest = static_cast<int>(i);
    least = distance;
  }
  if (nearest < 0) return std::nullopt;
  const Capsule& capsule = body.capsules[nearest];
  return BodyPoint{nearest, ClosestOnCapsule(joints[capsule.parent], joints[capsule.joint], capsule.radius, point)};
}

}  // namespace mocurate
