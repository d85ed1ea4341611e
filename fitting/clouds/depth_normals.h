#pragma once

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// Normals of the points of `thin`, up rather than down: of the planes through the points of `cloud` (3,m), metres,
/// that lie within `radius`. Points with few of those about them are stray (a depth camera's flying pixels) and
/// dropped.
void EstimateNormals(const Eigen::Matrix3Xd& cloud, double radius, FusedCloud& thin);

/// Turns normals of either sign out of the body: neighbours within `reach` agree, and each part that is connected
/// by such neighbours looks away from its middle.
void FaceOutwards(double reach, FusedCloud& cloud);

}  // namespace mocurate
