#include "core/geometry/triangulation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace mocurate {
namespace {

constexpr double kParallel = 1e-6;  ///< smallest singular values that still determine a point, relative to the largest

}  // namespace

std::optional<Vector3d> TriangulateLinear(const std::vector<ImageObservation>& sightings) {
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

std::optional<double> ReprojectionError(const ImageObservation& sighting, const Vector3d& point_in_world) {
  const std::optional<Vector2d> pixel = sighting.camera->ProjectWorld(point_in_world);
  if (!pixel) return std::nullopt;
  return (*pixel - sighting.pixel).norm();
}

std::optional<AxesMeeting> NearestPointToAxes(const std::vector<RigidTransform>& camera_from_world) {
  if (camera_from_world.size() < 2) return std::nullopt;
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  std::vector<Vector3d> centres;
  std::vector<Vector3d> axes;
  for (const RigidTransform& pose : camera_from_world) {
    const RigidTransform world_from_camera = Inverse(pose);
    centres.push_back(world_from_camera.translation);
    axes.push_back(world_from_camera.rotation * Vector3d::UnitZ());
    const Matrix3d across = Matrix3d::Identity() - axes.back() * axes.back().transpose();
    normal += across;
    right += across * centres.back();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(normal);
  if (eigen.eigenvalues()[0] <= kParallel * eigen.eigenvalues()[2]) return std::nullopt;
  AxesMeeting meeting;
  meeting.point =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose() * right;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const Vector3d to_point = meeting.point - centres[i];
    meeting.depth.push_back(to_point.dot(axes[i]));
    meeting.miss.push_back((to_point - meeting.depth.back() * axes[i]).norm());
  }
  return meeting;
}

}  // namespace mocurate
