#pragma once

#include <vector>

#include "core/body/flesh_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Moves the ends of a body's capsules in their joints' frames and changes their radii so that the points of some
/// frames lie on them, in poses that are known from elsewhere: linear least squares per capsule, left and right
/// together, with every change held to a person's usual difference from the template. `pose_variance` (J, m^2 per
/// axis): how uncertain the poses are, alike in all frames: flesh that lies off by that much tells of the pose, not of
/// the person. Returns which share of the usual variance of the flesh is left, mean over capsules. Needs Update of
/// these frames.
double CalibrateFlesh(const std::vector<FusedCloud>& clouds, const PoseState& state, const std::vector<int>& frames,
                      double max_distance, const std::vector<double>& pose_variance, FleshBody& body);

}  // namespace mocurate
