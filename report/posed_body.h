#pragma once

#include <vector>

#include "core/body/bone_capsules.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Capsules in the world, for drawing.
struct PosedBody {
  BoneCapsules capsules;         ///< Capsule::joint and ::parent are rows of `points`
  std::vector<Vector3d> points;  ///< ends of the capsules, world, metres
  std::vector<int> sides;        ///< of each capsule: 1 left, -1 right, 0 on the midline
};

/// The body of a clip in a frame: with the fitted radii in the clip's provenance, else one capsule per bone with the
/// skeleton's radii, scaled by the sum of the bone lengths over the rest lengths.
PosedBody BodyOf(const Clip& clip, int frame);

}  // namespace mocurate
