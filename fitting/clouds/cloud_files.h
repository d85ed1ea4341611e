#pragma once

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// The person in one frame of a clip's cloud files (PersonPoints of FusePoints). When the file has no normals, they are
/// estimated and face out of the body. Empty for a frame without a file. Errors of ReadFile, ParsePointCloud and
/// FusePoints; kInconsistent for a file that changed since ingestion.
Expected<FusedCloud> ReadPersonCloud(const CloudFiles& clouds, int frame, double voxel_size);

}  // namespace mocurate
