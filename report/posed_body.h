#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Capsules in the world as they are drawn.
struct PosedBody {
  CapsuleBody capsules;          ///< Capsule::joint and ::parent are rows of `points`
  std::vector<Vector3d> points;  ///< ends of the capsules, world, metres
  std::vector<int> sides;        ///< of each capsule: 1 left, -1 right, 0 on the midline
};

/// The body of a clip in a frame: as it was fitted where its provenance keeps the radii of a fitted body, else one
/// capsule per bone with the skeleton's radii, scaled by the sum of the bone lengths over the rest lengths.
PosedBody BodyOf(const Clip& clip, int frame);

}  // namespace mocurate
