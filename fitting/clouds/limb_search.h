#pragma once

#include <array>
#include <optional>
#include <vector>

#include "fitting/clouds/capsule_fit.h"

namespace mocurate {

/// The only child of a joint; -1 with several children or none, and for joint -1. `children` (J) as Skeleton::Children.
int OnlyChild(const std::vector<std::vector<int>>& children, int joint);

/// First joints of the legs, left then right; empty for a skeleton without legs.
std::optional<std::array<int, 2>> LegsOfBody(const Skeleton& skeleton);

/// Searches arms and legs anew, because a fit from a stance may miss them. Each limb is tried in some dozens of poses.
/// The poses with the lowest cost are fitted with the whole body, and a cheaper result is kept, until no limb improves.
/// Writes the cheapest pose to the state and returns its cost (PoseCost). Errors of FitCloudFrame.
Expected<double> SearchLimbs(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                             const PointCloudOptions& options, PoseState& state);

}  // namespace mocurate
