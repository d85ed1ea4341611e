#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/store/store.h"

namespace mocurate {

/// One skeleton for all clips: the one that most clips' rotations refer to (of equally many, the first in the order of
/// the clips). Where clips have rest directions of their own, it is the built-in one of that name, if it has that tree.
/// Rest directions are a person's own, like bone lengths. A clip of another tree, or whose rotations refer to another
/// rest pose (a BVH file in an A-pose among T-poses), is removed with a finding "other_skeleton". Frames are not read.
/// There must be a clip.
void UniteSkeletons(Dataset& dataset, std::vector<Finding>& findings);

/// "mixed_rates" for clips of several rates in one set.
void FindMixedRates(const Dataset& dataset, std::vector<Finding>& findings);

}  // namespace mocurate
