#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/store/store.h"

namespace mocurate {

/// One skeleton for all clips: the one that most have their rotations counted from (of equally many, the first in the
/// order of the clips); where these have directions of their own, the built-in one of that name, if it has that tree.
/// Where a person's bones point is the person's, like their lengths. A clip of another tree, or whose rotations are
/// counted from another rest pose (a BVH file in an A-pose among T-poses), leaves with a finding "other_skeleton".
/// Frames are not looked at. There must be a clip.
void UniteSkeletons(Dataset& dataset, std::vector<Finding>& findings);

/// "mixed_rates" where clips of several rates stand together.
void FindMixedRates(const Dataset& dataset, std::vector<Finding>& findings);

}  // namespace mocurate
