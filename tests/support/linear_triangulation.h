#pragma once

#include <Eigen/SVD>
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
inline std::optional<Vector3d> TriangulateLinear(const std::vector<ImageObservation>& sightings) {
  constexpr double kParallel = 1e-6;  // smallest singular values that still determine a point, relative to the largest
  Eigen::Matrix<double, Eigen::Dynamic, 4> equations(2 * static_cast<Eigen::Index>(sightings.size()), 4);
  // Relative to the first centre, so that the distance of the world's origin does not matter.
  std::optional<Vector3d> origin;
  Eigen::Index rows = 0;
  for (const ImageObservation& sighting : sightings) {
    if (!(sighting.weight > 0.0)) continue;
    if (!origin) origin = sighting.camera->Centre();
    const Vector3d ray = sighting.camera->Unproject(sighting.pixel, 1.0);
    Eigen::Matrix<double, 3, 4> projection;
    projection.leftCols<3>() = sighting.camera->camera_from_world.rotation.toRotationMatrix();
    projection.col(3) = sighting.camera->camera_from_world * *origin;
    for (int axis = 0; axis < 2; ++axis) {
      equations.row(rows++) = sighting.weight * (ray[axis] * projection.row(2) - projection.row(axis));
    }
  }
  if (rows < 4) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations.topRows(rows), Eigen::ComputeFullV);
  const Eigen::Vector4d point = svd.matrixV().col(3);
  if (svd.singularValues()[2] <= kParallel * svd.singularValues()[0]) return std::nullopt;
  if (std::abs(point[3]) <= kParallel * point.norm()) return std::nullopt;
  return Vector3d(point.head<3>() / point[3] + *origin);
}

/// Distance in pixels between the sighting and the projection of a point; empty when the point is not in front.
inline std::optional<double> ReprojectionError(const ImageObservation& sighting, const Vector3d& point_in_world) {
  const std::optional<Vector2d> pixel = sighting.camera->ProjectWorld(point_in_world);
  if (!pixel) return std::nullopt;
  return (*pixel - sighting.pixel).norm();
}

}  // namespace mocurate
