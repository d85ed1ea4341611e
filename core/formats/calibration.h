#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/camera.h"

namespace mocurate {

/// What the rotation R and the vector t of a calibration mean. Files rarely declare it.
enum class PoseConvention {
  kUnknown,
  kWorldToCamera,  ///< x_c = R X + t
  kCentre,         ///< x_c = R (X - t): t is the camera's centre
  kCameraToWorld,  ///< X = R x_c + t
};

/// "world_to_camera", "centre", "camera_to_world", "unknown".
std::string_view Name(PoseConvention reading);

/// One camera as its file gives it. Camera axes: x right, y down, z forward.
struct CalibratedView {
  std::string name;
  std::string world;  ///< views with the same text share a world (a subject of Human3.6M, a rig of PHSPD)
  std::string kind;   ///< "hd", "vga", ...; empty: not declared
  int width = 0;      ///< pixels; 0: not declared
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  LensDistortion distortion;
  Matrix3d rotation = Matrix3d::Identity();  ///< a rotation to the digits of the file
  Vector3d translation = Vector3d::Zero();   ///< file units
};

/// A calibration file of any dialect.
struct Calibration {
  std::string dialect;                                ///< "qualisys", "pose2sim_toml", ...
  PoseConvention reading = PoseConvention::kUnknown;  ///< where the format defines it
  double metres_per_unit = 0;                         ///< where the format defines it; 0: unknown
  std::vector<CalibratedView> views;
  /// Points that the cameras of their world looked at (calibration boards).
  struct SubjectPoint {
    std::string world;
    Vector3d position = Vector3d::Zero();  ///< file units
  };
  std::vector<SubjectPoint> subject_points;
};

/// The camera in metres. `reading` must not be kUnknown, `metres_per_unit` not 0. R is replaced by the nearest
/// rotation.
Camera CameraOf(const CalibratedView& view, PoseConvention reading, double metres_per_unit);

/// Pinhole numbers of a row-major 3 x 3 matrix into the view. Returns why it is not a camera matrix; empty if it is
/// one.
std::string SetIntrinsics(const std::vector<double>& matrix, CalibratedView& view);

}  // namespace mocurate
