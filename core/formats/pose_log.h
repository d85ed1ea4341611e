#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// One pose of a trajectory log.
struct LogPose {
  int first = 0, second = 0, frame = 0;      ///< the three numbers above the matrix
  Matrix3d rotation = Matrix3d::Identity();  ///< a rotation to the digits of the file
  Vector3d translation = Vector3d::Zero();   ///< file units
};

/// Open3D's trajectory (.log): per pose a line of three whole numbers and four lines of a 4 x 4 matrix. Whether it is
/// camera-to-world, as Open3D writes it, or its inverse the file does not say. Error kMalformed "name:line".
Expected<std::vector<LogPose>> ParsePoseLog(std::string_view bytes, const std::string& name);
std::string WritePoseLog(const std::vector<LogPose>& poses);

}  // namespace mocurate
