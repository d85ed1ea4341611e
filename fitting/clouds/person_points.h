#pragma once

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// The points of the person in a thinned cloud (y up, metres): without a floor (the lowest level area larger than a
/// person has, and what lies below it) and without walls (upright planes larger than a person), then the largest
/// connected part and the parts close to it. The order of the points stays; FusedCloud::excluded counts the others.
FusedCloud PersonPoints(const FusedCloud& cloud, double voxel_size);

}  // namespace mocurate
