#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/camera.h"

namespace mocurate {

struct JsonPlace;

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

/// A calibration as JSON, TOML, XML or pickle, by the file's content. Where a file does not declare the meaning of R
/// and t or its unit, the Calibration leaves it unknown (ingest/inspect/calibration_estimate.h estimates it). Errors
/// kMalformed and kInconsistent with the path of the field ("calib.json:/cameras/3/K"); kUnsupported when no format
/// matches.
///
/// TOML is Pose2Sim's and Anipose's: [cam] name, size, matrix, distortions (4 or 5), rotation (rotation vector),
/// translation. The format defines world-to-camera and metres; fisheye = true is kUnsupported.
///
/// JSON is one of
/// - plain: {"units": "metre", "convention": "x_cam = R X_world + t...", "cameras": [{name, size, K, dist_k1k2p1p2k3,
/// R,
///   t}]};
/// - Human3.6M (karfly): "intrinsics" per camera, "extrinsics" per subject and camera, R and t; a view per subject and
///   camera, world = the subject; the image size is known by the camera's number;
/// - Campus and Shelf (VoxelPose): an object of cameras by number: R, T, fx, fy, cx, cy, k (3), p (2), no image size;
/// - CMU Panoptic: "cameras" with name, type, resolution, K, distCoef (k1 k2 p1 p2 k3), R, t;
/// - ReadPhspdRigs.
Expected<Calibration> ParseCalibration(std::string_view bytes, const std::string& name);

/// PHSPD rigs: per rig the polarisation camera "p" (the world), Kinect v2 depth "d1".. and colour "c1".. cameras; poses
/// as qw qx qy qz tx ty tz, normalised here. The lens coefficients k1 k2 k3 are ignored, as in the source's own code.
/// The boards p1w.. are the subject points; the image sizes are those of the sensors (Kinect v2, 1224 x 1024).
Status ReadPhspdRigs(const JsonPlace& root, Calibration& calibration);

/// The set's own pickle of one rig (CamParams0906.pkl), of the same content; the rig is called as the file is.
Expected<Calibration> ParsePhspdRigPickle(std::string_view bytes, const std::string& name);

/// A Qualisys Track Manager calibration (.qca.txt, XML). The file's numbers are 1/64 px; its camera axes are x right, y
/// up, z backward: R = diag(1, -1, -1) Rq. The unit is millimetres, and x y z is the camera's centre. Error
/// kMalformed with "name:line" of the camera and the attribute.
Expected<Calibration> ParseQualisys(std::string_view bytes, const std::string& name);

/// Calibrations that OpenCV's FileStorage wrote as YAML or XML; `storages` are names and bytes of files. Rigs as
/// EasyMocap writes them, two files: `names`, K_n and dist_n (k1 k2 p1 p2, perhaps k3), W_n and H_n if there; and
/// Rot_n or R_n (rotation vector), T_n. Views, a file each: intrinsic (3 x 3), R (3 x 3), t (3). What R and T mean and
/// their unit is left unknown. Error kMalformed or kInconsistent with the field ("intri.yml:K_cam02") or the line;
/// kUnsupported: no calibration.
Expected<Calibration> ParseOpenCvCalibration(const std::vector<std::pair<std::string, std::string>>& storages);

/// Whether a text, however damaged, was written as a calibration: by keys that nothing else has together.
bool LooksLikeCalibration(std::string_view bytes);

}  // namespace mocurate
