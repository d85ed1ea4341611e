#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// Position on a body of a point that a tracker lists as a joint: fixed to a joint of the body, with a standard
/// deviation. A tracker's "neck" may lie between the shoulders.
struct PointPlace {
  std::string point;                   ///< joint of the tracker's skeleton
  std::string joint;                   ///< joint of the body (names of smpl24) that the point moves with
  Vector3d offset = Vector3d::Zero();  ///< in that joint's frame, rest pose, metres
  double spread = 0.0;                 ///< standard deviation per axis, metres: of people, clothes and the tracker
};

/// `on_body` of a skeleton of LoadSkeleton, in its order; empty for one whose joints are those of a body. Needs yaml.
Expected<std::vector<PointPlace>> LoadPointPlaces(const std::string& name_or_path);

}  // namespace mocurate
