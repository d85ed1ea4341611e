#include "core/body/bone_capsules.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/pi.h"

namespace mocurate {
namespace {

constexpr double kGoldenAngle = 2.39996322972865332;

/// Points of one capsule, evenly spread by area: on caps and cylinder the area per metre along the axis is 2 pi r
/// (Archimedes), so that equal steps along the axis with the golden angle around it are even.
void SampleCapsule(const Vector3d& parent_end, const Vector3d& joint_end, double radius, double spacing, int capsule,
                   std::vector<SurfaceSample>& samples) {
  const double length = (joint_end - parent_end).norm();
  const Quaterniond world_from_capsule = SwingBetween(Vector3d::UnitZ(), joint_end - parent_end);
  const double height = length + 2.0 * radius;
  const int count = std::max(1, static_cast<int>(std::lround(2.0 * kPi * radius * height / (spacing * spacing))));
  for (int i = 0; i < count; ++i) {
    const double along = height * (i + 0.5) / count - radius;
    const double on_bone = std::clamp(along, 0.0, length);
    const double rise = (along - on_bone) / radius;
    const double ring = std::sqrt(std::max(0.0, 1.0 - rise * rise));
    const double angle = kGoldenAngle * i;
    const Vector3d normal(ring * std::cos(angle), ring * std::sin(angle), rise);
    const Vector3d point = radius * normal + Vector3d(0.0, 0.0, on_bone);
    samples.push_back({capsule, parent_end + world_from_capsule * point, world_from_capsule * normal});
  }
}

}  // namespace

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

std::vector<SurfaceSample> SampleSurface(const BoneCapsules& body, const Vector3d* joints, double spacing) {
  std::vector<SurfaceSample> samples;
  for (std::size_t i = 0; i < body.capsules.size(); ++i) {
    const Capsule& capsule = body.capsules[i];
    SampleCapsule(joints[capsule.parent], joints[capsule.joint], capsule.radius, spacing, static_cast<int>(i), samples);
  }
  const auto is_covered = [&](const SurfaceSample& sample) {
    for (std::size_t i = 0; i < body.capsules.size(); ++i) {
      const Capsule& other = body.capsules[i];
      if (static_cast<int>(i) == sample.capsule) continue;
      const double distance = SignedDistance(joints[other.parent], joints[other.joint], other.radius, sample.point);
      if (distance < -1e-9) return true;
    }
    return false;
  };
  samples.erase(std::remove_if(samples.begin(), samples.end(), is_covered), samples.end());
  return samples;
}

}  // namespace mocurate
