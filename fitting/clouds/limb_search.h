#pragma once

#include <array>
#include <optional>
#include <vector>

#include "fitting/clouds/capsule_fit.h"

namespace mocurate {

/// The joint below one that has a single child; -1 for others, and for no joint (-1). `children` (J) as
/// Skeleton::Children.
int OnlyChild(const std::vector<std::vector<int>>& children, int joint);

/// Where legs begin, left then right; empty for a skeleton without any.
std::optional<std::array<int, 2>> LegsOfBody(const Skeleton& skeleton);

/// Looks for arms and legs anew where a fit from a stance may have left them: one limb at a time is put to some dozens
/// of poses, of which those that leave the least to explain are fitted with the whole body; what costs less stays,
/// until no limb finds a better place. The cheapest pose is left in the state. Returns what it costs (PoseCost). Errors
/// of FitCloudFrame.
Expected<double> SearchLimbs(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                             const PointCloudOptions& options, PoseState& state);

}  // namespace mocurate
