#include "core/body/bone_capsules.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mocurate {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Where the ray t * direction from the origin enters a ball; kNone if it does not.
double EnterBall(const Vector3d& centre, double radius, const Vector3d& direction) {
  const double square = direction.squaredNorm();
  const double along = direction.dot(centre);
  const double discriminant = along * along - square * (centre.squaredNorm() - radius * radius);
  if (discriminant < 0.0) return kNone;
  const double t = (along - std::sqrt(discriminant)) / square;
  return t > 0.0 ? t : kNone;
}

/// A capsule in the camera's frame.
struct PlacedCapsule {
  Vector3d begin;
  Vector3d axis;  ///< unit, or zero for a ball
  double length;
  double radius;

  PlacedCapsule(const Vector3d& parent_end, const Vector3d& joint_end, double capsule_radius)
      : begin(parent_end),
        axis((joint_end - parent_end).stableNormalized()),
        length((joint_end - parent_end).norm()),
        radius(capsule_radius) {}

  Vector3d end() const { return begin + length * axis; }

  double EnterMantle(const Vector3d& direction) const {
    const Vector3d across = direction - direction.dot(axis) * axis;
    const Vector3d centre = begin - begin.dot(axis) * axis;
    const double square = across.squaredNorm();
    if (length == 0.0 || square <= 0.0) return kNone;
    const double along = across.dot(centre);
    const double discriminant = along * along - square * (centre.squaredNorm() - radius * radius);
    if (discriminant < 0.0) return kNone;
    const double t = (along - std::sqrt(discriminant)) / square;
    const double height = (t * direction - begin).dot(axis);
    return t > 0.0 && height >= 0.0 && height <= length ? t : kNone;
  }

  /// The capsule is the union of its mantle and two balls, so the first entry into any of them is the surface.
  double Enter(const Vector3d& direction) const {
    return std::min({EnterMantle(direction), EnterBall(begin, radius, direction), EnterBall(end(), radius, direction)});
  }
};

/// Bounds of x/z and y/z of the visible part of a capsule.
struct RayBox {
  Vector2d low = Vector2d::Constant(kNone);
  Vector2d high = Vector2d::Constant(-kNone);

  bool Holds(const Vector2d& ray) const {
    return ray.x() >= low.x() && ray.x() <= high.x() && ray.y() >= low.y() && ray.y() <= high.y();
  }

  /// A ball entirely in front of the camera, in the plane of z and one other axis: between its two tangents.
  void AddBall(const Vector3d& centre, double radius) {
    for (int axis = 0; axis < 2; ++axis) {
      const double middle = std::atan2(centre[axis], centre.z());
      const double half = std::asin(std::min(1.0, radius / std::hypot(centre[axis], centre.z())));
      low[axis] = std::min(low[axis], std::tan(middle - half) - 1e-9);
      high[axis] = std::max(high[axis], std::tan(middle + half) + 1e-9);
    }
  }

  void AddAll() {
    low.setConstant(-kNone);
    high.setConstant(kNone);
  }
};

RayBox BoxOf(const PlacedCapsule& capsule) {
  RayBox box;
  const bool in_front = std::min(capsule.begin.z(), capsule.end().z()) > 1.001 * capsule.radius;
  if (!in_front) {
    box.AddAll();
    return box;
  }
  box.AddBall(capsule.begin, capsule.radius);
  box.AddBall(capsule.end(), capsule.radius);
  return box;
}

/// Pixels [first, end) along one side whose rays can lie in [low, high]; all of them with lens distortion.
std::pair<int, int> PixelSpan(const Camera& camera, double low, double high, double focal, double centre, int size) {
  if (!camera.distortion.IsZero()) return {0, size};
  if (focal < 0.0) std::swap(low, high);  // a mirrored picture
  const double first = std::clamp(std::floor(low * focal + centre), 0.0, static_cast<double>(size));
  const double last = std::clamp(std::ceil(high * focal + centre) + 1.0, first, static_cast<double>(size));
  return {static_cast<int>(first), static_cast<int>(last)};
}

void DrawCapsule(const PlacedCapsule& capsule, int index, const Camera& camera, const std::vector<Vector2d>& rays,
                 DepthRendering& rendering) {
  const RayBox box = BoxOf(capsule);
  const auto [left, right] = PixelSpan(camera, box.low.x(), box.high.x(), camera.fx, camera.cx, camera.width);
  const auto [top, bottom] = PixelSpan(camera, box.low.y(), box.high.y(), camera.fy, camera.cy, camera.height);
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * camera.width + x;
      if (!box.Holds(rays[pixel])) continue;
      const double depth = capsule.Enter(Vector3d(rays[pixel].x(), rays[pixel].y(), 1.0));
      if (depth == kNone) continue;
      if (rendering.capsule[pixel] >= 0 && depth >= rendering.depth[pixel]) continue;
      rendering.depth[pixel] = static_cast<float>(depth);
      rendering.capsule[pixel] = index;
    }
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
  CapsulePoint closest;
  closest.fraction = PlaceOnAxis(parent_end, joint_end, point);
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
  const double place = PlaceOnAxis(parent_end, joint_end, point);
  return (point - parent_end - place * (joint_end - parent_end)).norm() - radius;
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

std::vector<Vector2d> PixelRays(const Camera& camera) {
  std::vector<Vector2d> rays;
  rays.reserve(static_cast<std::size_t>(camera.width) * camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) rays.push_back(camera.Unproject(Vector2d(x, y), 1.0).head<2>());
  }
  return rays;
}

double FirstRayHit(const std::vector<PosedCapsule>& capsules, const Vector3d& direction, int but) {
  double first = kNone;
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    const PosedCapsule& capsule = capsules[i];
    if (static_cast<int>(i) == but) continue;
    if (SignedDistance(capsule.begin, capsule.end, capsule.radius, Vector3d::Zero()) <= 0.0) continue;
    first = std::min(first, PlacedCapsule(capsule.begin, capsule.end, capsule.radius).Enter(direction));
  }
  return first;
}

DepthRendering RenderCapsules(const std::vector<PosedCapsule>& capsules, const Camera& camera,
                              const std::vector<Vector2d>& rays) {
  DepthRendering rendering;
  rendering.depth.assign(rays.size(), 0.0F);
  rendering.capsule.assign(rays.size(), -1);
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    const Vector3d begin = camera.camera_from_world * capsules[i].begin;
    const Vector3d end = camera.camera_from_world * capsules[i].end;
    if (SignedDistance(begin, end, capsules[i].radius, Vector3d::Zero()) <= 0.0) continue;
    DrawCapsule(PlacedCapsule(begin, end, capsules[i].radius), static_cast<int>(i), camera, rays, rendering);
  }
  return rendering;
}

DepthRendering RenderBody(const BoneCapsules& body, const Vector3d* joints, const Camera& camera,
                          const std::vector<Vector2d>& rays) {
  std::vector<PosedCapsule> capsules;
  for (const Capsule& capsule : body.capsules) {
    capsules.push_back({joints[capsule.parent], joints[capsule.joint], capsule.radius});
  }
  return RenderCapsules(capsules, camera, rays);
}

}  // namespace mocurate
