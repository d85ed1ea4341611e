#pragma once

#include <string>
#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/observed_rig.h"
#include "fitting/options.h"

namespace mocurate {

/// "views_disagree" of views that contradict every other one by `losses` (LossOfSamples): after all that could be
/// reported their clocks may be off by more than the longest, or they see something else. Corrected, which is excluded,
/// where clocks, places and files are to be corrected and most views agree with another one.
std::vector<RigFault> FindInconsistentViews(const ObservedRig& rig, const std::vector<double>& losses,
                                            const RigAuditOptions& options);

/// Adds `inconsistent_views` to the findings. An excluded view gets no other finding: a clock or place at which it
/// contradicts the others a little less is not what is wrong with it.
void ReportInconsistentViews(std::vector<RigFault> inconsistent_views, std::vector<RigFault>& faults);

/// The views but those whose `faults` of FindInconsistentViews are corrected.
std::vector<DepthView> WithoutInconsistentViews(std::vector<DepthView> views, const std::vector<RigFault>& faults);

/// (V) views whose cameras may have been moved, by the mean loss of each: all but the one that agrees best, of more
/// than kFewViews those that stick out.
inline constexpr std::size_t kFewViews = 8;
std::vector<bool> MayHaveMoved(const std::vector<double>& loss_of_views);

/// "views_disagree" of each camera of a rig of three and more that a moment or two cannot judge further, where what one
/// sees misses the surfaces of the others by more than noise does. `losses` (views), means of LossOfSamples.
std::vector<RigFault> ContradictionOf(const std::vector<std::string>& cameras, const std::vector<double>& losses);

}  // namespace mocurate
