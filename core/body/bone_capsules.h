#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// All points within `radius` metres of the bone from `parent` to `joint` (indices of the skeleton).
struct Capsule {
  int joint = 0;
  int parent = 0;
  double radius = 0.0;
};

/// A body made of one capsule per bone of a skeleton. Posed by joint positions: everywhere below `joints` points to J
/// world positions in metres, in the skeleton's order.
struct BoneCapsules {
  SkeletonPtr skeleton;
  std::vector<Capsule> capsules;  ///< in the order of their joints

  /// Radii are Joint::radius times `radius_scale`; a joint of radius 0 gets no capsule.
  static BoneCapsules Make(SkeletonPtr skeleton, double radius_scale = 1.0);
};

/// Place [0, 1] on the axis from `begin` to `end` that is nearest to a point; 0 where both coincide.
inline double PlaceOnAxis(const Vector3d& begin, const Vector3d& end, const Vector3d& point) {
  const Vector3d axis = end - begin;
  const double square = axis.squaredNorm(), along = (point - begin).dot(axis);
  return square > 0.0 && along > 0.0 ? std::min(1.0, along / square) : 0.0;
}

/// The point of a capsule's surface nearest to another point.
struct CapsulePoint {
  double distance = 0.0;               ///< metres from the point to the surface, negative inside
  double fraction = 0.0;               ///< place on the bone: 0 at the parent, 1 at the joint
  Vector3d point = Vector3d::Zero();   ///< on the surface, world
  Vector3d normal = Vector3d::Zero();  ///< outward unit normal there; on the bone itself a fixed perpendicular
};

/// For a capsule between two ends; coinciding ends make a ball.
CapsulePoint ClosestOnCapsule(const Vector3d& parent_end, const Vector3d& joint_end, double radius,
                              const Vector3d& point);
double SignedDistance(const Vector3d& parent_end, const Vector3d& joint_end, double radius, const Vector3d& point);

struct BodyPoint {
  int capsule = 0;  ///< index into BoneCapsules::capsules
  CapsulePoint on_capsule;
};

/// Nearest capsule by signed distance (the deepest one inside the body); the first of equals. Empty for a body without
/// capsules.
std::optional<BodyPoint> ClosestOnBody(const BoneCapsules& body, const Vector3d* joints, const Vector3d& point);

/// A capsule wherever it is: two ends and a radius, metres.
struct PosedCapsule {
  Vector3d begin = Vector3d::Zero();
  Vector3d end = Vector3d::Zero();
  double radius = 0.0;
};

/// The least t > 0 at which t * `direction` from the origin enters one of the capsules, whatever the length of
/// `direction`; infinity where it enters none. A capsule that contains the origin is passed over, as is the one of
/// index `but`.
double FirstRayHit(const std::vector<PosedCapsule>& capsules, const Vector3d& direction, int but = -1);

/// Direction of each pixel's ray in the camera's frame, scaled to z = 1: (height*width), row-major. Worth keeping when
/// many frames of one camera with lens distortion are rendered.
std::vector<Vector2d> PixelRays(const Camera& camera);

/// A rendered view; row-major, (height*width).
struct DepthRendering {
  std::vector<float> depth;  ///< metres along the camera's z axis, 0 where no capsule is hit
  std::vector<int> capsule;  ///< the visible capsule, -1 for none
};

/// Exact intersection of every pixel's ray with every capsule; capsules that contain the camera are not drawn.
DepthRendering RenderBody(const BoneCapsules& body, const Vector3d* joints, const Camera& camera,
                          const std::vector<Vector2d>& rays);
/// The same for capsules in the world.
DepthRendering RenderCapsules(const std::vector<PosedCapsule>& capsules, const Camera& camera,
                              const std::vector<Vector2d>& rays);

}  // namespace mocurate
