#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
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

/// Metres between a view's person and the others'; at larger distances their surfaces do not meet.
inline constexpr double kAside = 0.12;

/// Offset of each view's person from that of the others, in the world: between the centres of the points, moved a
/// little behind the surface. Zero when no moment shows both.
std::vector<Vector3d> AsideOf(const ObservedRig& rig, const std::vector<Camera>& cameras);

/// A view with wrong depths, by an offset or by a scale; both are equivalent at one distance.
struct WrongDepths {
  std::size_t view = 0;
  double factor = 1.0;           ///< that corrects them
  double too_long = 0.0;         ///< metres at the person; negative: too short
  double loss = 0.0;             ///< of the rig (MeanLoss) with corrected depths
  std::vector<double> held_out;  ///< LossOfSamples, each half with the factor that the other half chooses
};

/// The view whose person has the largest offset from the others, if along its line of sight. Includes the factor on its
/// depths with the lowest loss. Unlike a moved camera, wrong depths also change the size of the person. Errors of
/// ReadFrame.
Expected<std::optional<WrongDepths>> FindWrongDepths(const DepthRigSampler& sampler, const std::vector<int>& delays,
                                                     const ObservedRig& rig, const std::vector<Camera>& cameras);

/// The views with the depths of one times `factor`.
std::vector<DepthView> WithDepths(std::vector<DepthView> views, std::size_t view, double factor);

/// The fault; the audit sets confidence and correction.
RigFault DepthsOff(const std::string& camera, const WrongDepths& wrong);

}  // namespace mocurate
