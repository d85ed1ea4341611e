#pragma once

#include <optional>
#include <vector>

#include "core/geometry/camera.h"

namespace mocurate {

/// One view's sight of a point.
struct ImageObservation {
  const Camera* camera = nullptr;
  Vector2d pixel = Vector2d::Zero();
  double weight = 1.0;  ///< a detector's confidence; 0: not detected, not read
};

/// Linear triangulation (DLT; Hartley and Zisserman, section 12.2) of undistorted rays, each view's two equations times
/// its weight. World, metres. Empty with fewer than two views that see the point, or when their rays are parallel.
/// No outlier rejection, and the point may lie behind a camera.
std::optional<Vector3d> TriangulateLinear(const std::vector<ImageObservation>& sightings);

/// Distance in pixels between the sighting and the projection of a point; empty when the point is not in front.
std::optional<double> ReprojectionError(const ImageObservation& sighting, const Vector3d& point_in_world);

/// The point nearest to the optical axes of cameras, in the least-squares sense.
struct AxesMeeting {
  Vector3d point = Vector3d::Zero();
  std::vector<double> miss;   ///< (cameras) distance of the point from the axis
  std::vector<double> depth;  ///< (cameras) distance along the axis; negative behind the camera
};

/// Empty for fewer than two cameras or when all axes are parallel (to 1e-6).
std::optional<AxesMeeting> NearestPointToAxes(const std::vector<RigidTransform>& camera_from_world);

}  // namespace mocurate
