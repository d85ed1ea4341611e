#pragma once

#include <string>
#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/observed_rig.h"
#include "fitting/options.h"

namespace mocurate {

/// "views_disagree" for views that contradict all others by `losses` (LossOfSamples), after all other corrections.
/// Their clock offset exceeds the limit, or they show another scene. Corrected (excluded) where clocks, poses and files
/// are to be corrected and most views agree with another one.
std::vector<RigFault> FindInconsistentViews(const ObservedRig& rig, const std::vector<double>& losses,
                                            const RigAuditOptions& options);

/// Adds `inconsistent_views` to the faults. Removes other faults of an excluded view: a clock or pose with a slightly
/// lower loss is not its problem.
void ReportInconsistentViews(std::vector<RigFault> inconsistent_views, std::vector<RigFault>& faults);

/// The views without those of corrected `faults` of FindInconsistentViews.
std::vector<DepthView> WithoutInconsistentViews(std::vector<DepthView> views, const std::vector<RigFault>& faults);

/// Views up to which all but the best one may have been moved; with more, only the outliers (numerical).
inline constexpr std::size_t kFewViews = 8;
std::vector<bool> MayHaveMoved(const std::vector<double>& loss_of_views);

/// For rigs of three and more with too few moments for an audit. "views_disagree" for each camera whose surfaces miss
/// those of the others by more than noise. `losses` (views): means of LossOfSamples.
std::vector<RigFault> ContradictionOf(const std::vector<std::string>& cameras, const std::vector<double>& losses);

}  // namespace mocurate
