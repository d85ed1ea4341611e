#pragma once

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// The points of the person in a thinned cloud (y up, metres). Removes a floor (the lowest level area larger than a
/// person's, and all below it) and walls (upright planes larger than a person). Keeps the largest connected part and
/// parts close to it. Preserves the order; FusedCloud::excluded counts the others.
FusedCloud PersonPoints(const FusedCloud& cloud, double voxel_size);

}  // namespace mocurate
