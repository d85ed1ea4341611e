#include "core/formats/calibration.h"

#include <cmath>

#include "core/base/text.h"

namespace mocurate {

std::string_view Name(PoseConvention reading) {
  constexpr std::string_view kNames[] = {"unknown", "world_to_camera", "centre", "camera_to_world"};
  return kNames[static_cast<std::size_t>(reading)];
}

Camera CameraOf(const CalibratedView& view, PoseConvention reading, double metres_per_unit) {
  Camera camera;
  camera.name = view.name;
  camera.width = view.width;
  camera.height = view.height;
  camera.fx = view.fx, camera.fy = view.fy, camera.cx = view.cx, camera.cy = view.cy;
  camera.distortion = view.distortion;
  const Quaterniond rotation = Quaterniond(NearestRotation(view.rotation)).normalized();
  const Vector3d t = view.translation * metres_per_unit;
  if (reading == PoseConvention::kCameraToWorld) {
    camera.camera_from_world = Inverse(RigidTransform{rotation, t});
  } else if (reading == PoseConvention::kCentre) {
    camera.camera_from_world = {rotation, -(rotation * t)};
  } else {
    camera.camera_from_world = {rotation, t};
  }
  return camera;
}

std::string SetIntrinsics(const std::vector<double>& matrix, CalibratedView& view) {
  view.fx = matrix[0], view.cx = matrix[2], view.fy = matrix[4], view.cy = matrix[5];
  if (!(view.fx > 0.0) || !(view.fy > 0.0)) {
    return "the focal lengths must be positive, not " + FormatDouble(view.fx) + " and " + FormatDouble(view.fy) +
           " px: correct them, or remove the camera";
  }
  if (matrix[3] != 0.0 || matrix[6] != 0.0 || matrix[7] != 0.0 || matrix[8] != 1.0) {
    return "the matrix is not a camera matrix (fx s cx; 0 fy cy; 0 0 1)";
  }
  if (std::abs(matrix[1]) > 1e-6 * view.fx) return "a skew of " + FormatDouble(matrix[1]) + " px is not supported";
  return {};
}

}  // namespace mocurate
