#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

struct PanopticBody {
  int id = 0;
  std::vector<Vector3d> position_cm;  ///< (joints); not to be read where confidence is below 0
  std::vector<double> confidence;     ///< (joints); -1: missing
};

/// CMU Panoptic body3DScene_*.json: the people of one moment, y pointing down.
struct PanopticBodies {
  double version = 0;
  double time_ms = 0;    ///< "univTime"
  std::string fps_type;  ///< "hd_29_97"
  std::vector<PanopticBody> bodies;
};

/// Joints in order of coco19, of which the 15 of older files are the first.
const std::vector<std::string>& PanopticJointNames();

/// "joints19", or "joints15" of older files. Error kMalformed with the path.
Expected<PanopticBodies> ParsePanopticBodies(std::string_view bytes, const std::string& name);

}  // namespace mocurate
