#pragma once

#include <string>
#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/seen_rig.h"
#include "fitting/options.h"

namespace mocurate {

/// "views_disagree" of views that contradict every other one by `losses` (LossOfSamples): after all that could be told
/// their clocks may be off by more than the longest, or they see something else. Corrected, which is left out, where
/// clocks, places and files are to be corrected and most views agree with another one.
std::vector<RigFault> StrangersOf(const SeenRig& rig, const std::vector<double>& losses,
                                  const RigAuditOptions& options);

/// Adds `strangers` to what is told. Of one that is left out nothing else is: a clock or place at which it contradicts
/// the others a little less is not what is wrong with it.
void TellOfStrangers(std::vector<RigFault> strangers, std::vector<RigFault>& faults);

/// The views but those whose `faults` of StrangersOf are corrected.
std::vector<DepthView> WithoutStrangers(std::vector<DepthView> views, const std::vector<RigFault>& faults);

/// (V) views whose cameras may have been moved, by the mean loss of each: all but the one that agrees best, of more
/// than kFewViews those that stick out.
inline constexpr std::size_t kFewViews = 8;
std::vector<bool> MayHaveMoved(const std::vector<double>& loss_of_views);

/// "views_disagree" of each camera of a rig of three and more that a moment or two cannot judge further, where what one
/// sees misses the surfaces of the others by more than noise does. `losses` (views), means of LossOfSamples.
std::vector<RigFault> ContradictionOf(const std::vector<std::string>& cameras, const std::vector<double>& losses);

}  // namespace mocurate
