#pragma once

#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/seen_rig.h"

namespace mocurate {

/// "views_disagree" of views that contradict every other one by `losses` (LossOfSamples): after all that could be told
/// their clocks may be off by more than `longest_s`, or they see something else.
std::vector<RigFault> StrangersOf(const SeenRig& rig, const std::vector<double>& losses, double longest_s);

}  // namespace mocurate
