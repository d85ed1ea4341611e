#pragma once

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// Estimates normals of the points of `thin`, up rather than down, from the planes through points of `cloud` (3,m;
/// metres) within `radius`. Points with few neighbours (flying pixels) are dropped.
void EstimateNormals(const Eigen::Matrix3Xd& cloud, double radius, FusedCloud& thin);

/// Orients normals out of the body: neighbours within `reach` agree, and each connected part faces away from its
/// centre.
void FaceOutwards(double reach, FusedCloud& cloud);

}  // namespace mocurate
