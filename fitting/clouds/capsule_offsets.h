#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Fits capsule ends (in their joints' frames) and radii to the points of some frames with known poses. Linear least
/// squares per capsule, left and right together, with a prior from the usual variation between people and template.
/// `pose_variance` (J, m^2 per axis) is the uncertainty of the poses, common to all frames: an offset of that size is
/// attributed to the pose. Returns the share of the prior shape variance that remains, mean over capsules. Needs Update
/// of these frames.
double FitCapsuleOffsets(const std::vector<FusedCloud>& clouds, const PoseState& state, const std::vector<int>& frames,
                         double max_distance, const std::vector<double>& pose_variance, CapsuleBody& body);

}  // namespace mocurate
