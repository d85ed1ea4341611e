#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid.h"

namespace mocurate {

/// OpenCV model: x' = x(1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 x y + p2 (r2 + 2 x^2), y' likewise (p1 and p2 swapped).
struct LensDistortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  bool IsZero() const { return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0; }
};

/// A calibrated view. Camera axes: x right, y down, z forward. Pixels: the centre of the first pixel is (0, 0).
struct Camera {
  std::string name;
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  LensDistortion distortion;
  RigidTransform camera_from_world;  ///< metres

  /// Pixel of a point in the camera's frame; empty when the point is not in front (z <= 0).
  std::optional<Vector2d> Project(const Vector3d& point_in_camera) const;
  std::optional<Vector2d> ProjectWorld(const Vector3d& point_in_world) const;

  /// Point in the camera's frame at `depth` metres along z behind a pixel; distortion is inverted by damped Newton
  /// steps to rounding; beyond the radius where it folds back the ray is finite, but not exact.
  Vector3d Unproject(const Vector2d& pixel, double depth) const;

  /// Centre of projection in the world.
  Vector3d Centre() const;
};

/// The point nearest to the optical axes of cameras, in the least-squares sense.
struct AxesMeeting {
  Vector3d point = Vector3d::Zero();
  std::vector<double> miss;   ///< (cameras) distance of the point from the axis
  std::vector<double> depth;  ///< (cameras) distance along the axis; negative behind the camera
};

/// Empty for fewer than two cameras or when all axes are parallel (to 1e-6).
std::optional<AxesMeeting> NearestPointToAxes(const std::vector<RigidTransform>& camera_from_world);

/// Raw depth values of a sensor, row-major, (height*width); 0 means nothing measured.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;
};

/// Mask of a person's pixels, row-major, (height*width): 0 or 1.
struct PixelMask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> inside;
};

/// Every measured pixel (inside the mask, if given), in the order of the pixels, as a point in the camera's frame,
/// metres: depth is along the optical axis, lens distortion is inverted. The camera's image size is not read; a mask of
/// another size than the image gives nothing.
std::vector<Vector3d> BackProject(const DepthImage& depth, const Camera& camera, double metres_per_unit,
                                  const PixelMask* mask = nullptr);

}  // namespace mocurate
