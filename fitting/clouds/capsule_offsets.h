#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Moves the ends of a body's capsules in their joints' frames and changes their radii so that the points of some
/// frames lie on them, in poses that are known from elsewhere: linear least squares per capsule, left and right
/// together, with every change held to a person's usual difference from the template. `pose_variance` (J, m^2 per
/// axis): how uncertain the poses are, alike in all frames: an offset of that size is an error of the pose, not of
/// the person's shape. Returns the share of the shape's usual variance that is left, mean over capsules. Needs Update
/// of these frames.
double FitCapsuleOffsets(const std::vector<FusedCloud>& clouds, const PoseState& state, const std::vector<int>& frames,
                         double max_distance, const std::vector<double>& pose_variance, CapsuleBody& body);

}  // namespace mocurate
