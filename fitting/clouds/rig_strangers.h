#pragma once

#include <string>
#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/seen_rig.h"

namespace mocurate {

/// "views_disagree" of views that contradict every other one by `losses` (LossOfSamples): after all that could be told
/// their clocks may be off by more than `longest_s`, or they see something else.
std::vector<RigFault> StrangersOf(const SeenRig& rig, const std::vector<double>& losses, double longest_s);

/// (V) views whose cameras may have been moved, by the mean loss of each: all but the one that agrees best, of more
/// than kFewViews those that stick out.
inline constexpr std::size_t kFewViews = 8;
std::vector<bool> MayHaveMoved(const std::vector<double>& loss_of_views);

/// "views_disagree" of each camera of a rig of three and more that a moment or two cannot judge further, where what one
/// sees misses the surfaces of the others by more than noise does. `losses` (views), means of LossOfSamples.
std::vector<RigFault> ContradictionOf(const std::vector<std::string>& cameras, const std::vector<double>& losses);

}  // namespace mocurate
