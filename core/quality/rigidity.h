#pragma once

#include "core/quality/tracked_points.h"

namespace mocurate {

struct RigidityLimits {
  double spread = 0.35;      ///< of a bone's length: standard deviation over length, median over the bones
  double proportion = 0.33;  ///< mean distance of the bones' log lengths from those at rest, after the best scale
};

/// Numbers of the right shape that are not joint positions: rotations (Lie parameters in a file named joints),
/// features, joints in another order. Bones keep their length, also badly tracked ones, and their proportions are a
/// person's (trackers are off by 0.2 at most, Lie parameters by 0.4 and more, although they too may hardly change).
/// "not_joint_positions", severity error; value: the one that is over its limit, proportion (as a factor) first. Needs
/// `parents` with three bones, `rest_lengths` for the proportions, and 8 frames for the spread; else nothing is
/// reported.
std::vector<Finding> FindNonRigidBody(const TrackedPoints& points, const RigidityLimits& limits = {});

}  // namespace mocurate
