#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/formats/calibration.h"

namespace mocurate {

/// Calibrations as JSON, TOML, XML and YAML, each with its own layout. Where a file does not declare the meaning of R
/// and t or its unit, the Calibration leaves it unknown (ingest/inspect/calibration_estimate.h estimates it). Errors
/// kMalformed and kInconsistent with the path of the field ("calib.json:/cameras/3/K").

/// Pose2Sim and Anipose: [cam] name, size, matrix, distortions (4 or 5), rotation (rotation vector), translation. The
/// format defines world-to-camera and metres; fisheye = true is kUnsupported.
Expected<Calibration> ParsePose2SimToml(std::string_view bytes, const std::string& name);

/// {"units": "metre", "convention": "x_cam = R X_world + t...", "cameras": [{name, size, K, dist_k1k2p1p2k3, R, t}]}.
Expected<Calibration> ParsePlainCameras(std::string_view bytes, const std::string& name);

/// Human3.6M (karfly): "intrinsics" per camera, "extrinsics" per subject and camera, R and t. A view per subject and
/// camera, world = the subject. The image size is known by the camera's number.
Expected<Calibration> ParseHuman36m(std::string_view bytes, const std::string& name);

/// Campus and Shelf (VoxelPose): an object of cameras by number: R, T, fx, fy, cx, cy, k (3), p (2). No image size.
Expected<Calibration> ParseCampusShelf(std::string_view bytes, const std::string& name);

/// CMU Panoptic: "cameras" with name, type, resolution, K, distCoef (k1 k2 p1 p2 k3), R, t.
Expected<Calibration> ParsePanopticCameras(std::string_view bytes, const std::string& name);

/// PHSPD rigs: per rig the polarisation camera "p" (the world), Kinect v2 depth "d1".. and colour "c1".. cameras; poses
/// as qw qx qy qz tx ty tz, normalised here. The lens coefficients k1 k2 k3 are ignored, as in the source's own code.
/// The boards p1w.. are the subject points; the image sizes are those of the sensors (Kinect v2, 1224 x 1024).
Expected<Calibration> ParsePhspdRigs(std::string_view bytes, const std::string& name);

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

/// Any of them, and Qualisys, by the file's content. Error kUnsupported when no format matches.
Expected<Calibration> ParseCalibration(std::string_view bytes, const std::string& name);

}  // namespace mocurate
