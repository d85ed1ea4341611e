#pragma once

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// The points of the person in a thinned cloud (y up, metres). Removes a floor (the lowest level area larger than a
/// person's, and all below it) and walls (upright planes larger than a person). Keeps the largest connected part and
/// parts close to it. Preserves the order; FusedCloud::excluded counts the others.
FusedCloud PersonPoints(const FusedCloud& cloud, double voxel_size);

/// The person in one frame of a clip's cloud files (PersonPoints of FusePoints). When the file has no normals, they are
/// estimated and face out of the body. Empty for a frame without a file. Errors of ReadFile, ParsePointCloud and
/// FusePoints; kInconsistent for a file that changed since ingestion.
Expected<FusedCloud> ReadPersonCloud(const CloudFiles& clouds, int frame, double voxel_size);

}  // namespace mocurate
