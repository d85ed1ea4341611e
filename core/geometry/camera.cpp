#include "core/geometry/camera.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace mocurate {
namespace {

using Eigen::Matrix2d;

constexpr int kMaxIterations = 100;
constexpr double kTolerance = 1e-14;  ///< normalised units
constexpr double kParallel = 1e-6;    ///< least eigenvalue that still determines a point, relative to the largest

/// Distorted normalised point; `jacobian`, if not null, receives its derivative.
Vector2d Distort(const LensDistortion& d, const Vector2d& p, Matrix2d* jacobian = nullptr) {
  const double x = p.x();
  const double y = p.y();
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  if (jacobian != nullptr) {
    const double slope = 2.0 * (d.k1 + r2 * (2.0 * d.k2 + 3.0 * r2 * d.k3));  // d radial / d x = slope * x
    const double mixed = slope * x * y + 2.0 * d.p1 * x + 2.0 * d.p2 * y;
    *jacobian << radial + slope * x * x + 2.0 * d.p1 * y + 6.0 * d.p2 * x, mixed,  //
        mixed, radial + slope * y * y + 6.0 * d.p1 * y + 2.0 * d.p2 * x;
  }
  return {x * radial + 2.0 * d.p1 * x * y + d.p2 * (r2 + 2.0 * x * x),
          y * radial + d.p1 * (r2 + 2.0 * y * y) + 2.0 * d.p2 * x * y};
}

/// Damped Newton from the distorted point: stays on the branch around the optical axis, where the Jacobian is positive.
Vector2d Undistort(const LensDistortion& distortion, const Vector2d& distorted) {
  Vector2d point = distorted;
  Matrix2d jacobian;
  Vector2d residual = Distort(distortion, point, &jacobian) - distorted;
  for (int i = 0; i < kMaxIterations && residual.norm() > kTolerance; ++i) {
    const double determinant = jacobian.determinant();
    const Vector2d step = determinant > 1e-9 ? Vector2d(jacobian.inverse() * residual) : residual;
    double scale = 1.0;
    Vector2d next = point - step;
    Matrix2d next_jacobian;
    Vector2d next_residual = Distort(distortion, next, &next_jacobian) - distorted;
    while (!(next_residual.norm() < residual.norm()) && scale > 1e-6) {
      scale *= 0.5;
      next = point - scale * step;
      next_residual = Distort(distortion, next, &next_jacobian) - distorted;
    }
    if (!(next_residual.norm() < residual.norm())) break;
    point = next;
    residual = next_residual;
    jacobian = next_jacobian;
  }
  return point;
}

}  // namespace

std::optional<Vector2d> Camera::Project(const Vector3d& point_in_camera) const {
  if (!(point_in_camera.z() > 0.0)) return std::nullopt;
  const Vector2d normalised = point_in_camera.head<2>() / point_in_camera.z();
  const Vector2d distorted = distortion.IsZero() ? normalised : Distort(distortion, normalised);
  return Vector2d(fx * distorted.x() + cx, fy * distorted.y() + cy);
}

std::optional<Vector2d> Camera::ProjectWorld(const Vector3d& point_in_world) const {
  return Project(camera_from_world * point_in_world);
}

Vector3d Camera::Unproject(const Vector2d& pixel, double depth) const {
  const Vector2d distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  const Vector2d normalised = distortion.IsZero() ? distorted : Undistort(distortion, distorted);
  return {normalised.x() * depth, normalised.y() * depth, depth};
}

Vector3d Camera::Centre() const { return Inverse(camera_from_world).translation; }

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

std::vector<Vector3d> BackProject(const DepthImage& depth, const Camera& camera, double metres_per_unit,
                                  const PixelMask* mask) {
  std::vector<Vector3d> points;
  if (mask != nullptr && (mask->width != depth.width || mask->height != depth.height)) return points;
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const std::size_t pixel = static_cast<std::size_t>(v) * depth.width + u;
      if (depth.values[pixel] == 0 || (mask != nullptr && mask->inside[pixel] == 0)) continue;
      points.push_back(camera.Unproject(Vector2d(u, v), depth.values[pixel] * metres_per_unit));
    }
  }
  return points;
}

}  // namespace mocurate
