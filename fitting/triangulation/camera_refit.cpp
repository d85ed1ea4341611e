#include "fitting/triangulation/camera_refit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr int kIterations = 20;                ///< Gauss-Newton steps, at most (numerical)
constexpr std::size_t kLeastDetections = 100;  ///< detections for a refit, at least
constexpr double kHuber = 10.0;                ///< px; scale of Huber's loss
constexpr double kNearest = 1e-3;              ///< m in front of the camera, at least (numerical)

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Detection {
  Vector3d point;       ///< world
  Vector2d normalised;  ///< at depth 1
  double weight = 0.0;
};

Vector2d ErrorOf(const Camera& camera, const RigidTransform& pose, const Detection& seen, Vector3d& at) {
  at = pose * seen.point;
  const Vector2d off = at.head<2>() / at.z() - seen.normalised;
  return {camera.fx * off.x(), camera.fy * off.y()};
}

double MedianErrorOfPose(const Camera& camera, const RigidTransform& pose, const std::vector<Detection>& detections) {
  std::vector<double> errors;
  Vector3d at;
  for (const Detection& seen : detections) {
    const Vector2d error = ErrorOf(camera, pose, seen, at);
    errors.push_back(at.z() > kNearest ? error.norm() : 1e6);
  }
  return MeanMedian(errors);
}

}  // namespace

std::optional<CameraRefit> RefitCamera(const ViewKeypoints& view, const TriangulatedTracks& points, double improved) {
  std::vector<Detection> detections;
  for (std::size_t i = 0; i < points.confidence.size(); ++i) {
    if (points.confidence[i] <= 0.0 || view.confidence[i] <= 0.0) continue;
    const Vector2d normalised =
        view.normalised.empty() ? Vector2d(view.camera.Unproject(view.pixel[i], 1.0).head<2>()) : view.normalised[i];
    const Eigen::Map<const Vector3d> point(points.positions.xyz.data() + 3 * i);
    detections.push_back({point, normalised, view.confidence[i]});
  }
  if (detections.size() < kLeastDetections) return {};
  CameraRefit refit;
  refit.camera = view.camera;
  RigidTransform& pose = refit.camera.camera_from_world;
  refit.before_px = MedianErrorOfPose(view.camera, pose, detections);
  for (int i = 0; i < kIterations; ++i) {
    Matrix6 normal = Matrix6::Identity() * 1e-9;
    Vector6 gradient = Vector6::Zero();
    for (const Detection& seen : detections) {
      Vector3d at;
      const Vector2d error = ErrorOf(view.camera, pose, seen, at);
      if (at.z() < kNearest) continue;
      Eigen::Matrix<double, 2, 3> slope;
      slope << view.camera.fx / at.z(), 0.0, -view.camera.fx * at.x() / (at.z() * at.z()),  //
          0.0, view.camera.fy / at.z(), -view.camera.fy * at.y() / (at.z() * at.z());
      Eigen::Matrix<double, 2, 6> jacobian;
      jacobian << -slope * Hat(at), slope;  // rotation about the camera's axes, then translation
      const double weight = seen.weight * std::min(1.0, kHuber / std::max(error.norm(), 1e-9));
      normal += weight * jacobian.transpose() * jacobian;
      gradient += weight * jacobian.transpose() * error;
    }
    const Vector6 step = -normal.ldlt().solve(gradient);
    if (!step.allFinite()) return {};
    const Quaterniond rotation_step = ExpQuaternion(step.head<3>());
    pose.rotation = (rotation_step * pose.rotation).normalized();
    pose.translation = rotation_step * pose.translation + step.tail<3>();
    if (step.norm() < 1e-9) break;
  }
  refit.after_px = MedianErrorOfPose(view.camera, pose, detections);
  if (!(refit.after_px < improved * refit.before_px)) return {};
  refit.moved_m = (refit.camera.Centre() - view.camera.Centre()).norm();
  refit.rotation_rad = refit.camera.camera_from_world.rotation.angularDistance(view.camera.camera_from_world.rotation);
  return refit;
}

}  // namespace mocurate
