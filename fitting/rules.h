#pragma once

#include <bitset>
#include <string>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// Rules of a fit that have no option of their own. All are on; `fitting.without` switches single ones off to measure
/// what each contributes (docs/fitting_ablation.md says what happens without each).
enum class FittingRule {
  // Stated uncertainty of all fits.
  kBodyErrors,
  // Of joint tracks and triangulated keypoints.
  kUncertaintyCalibration,
  kVarianceFactor,
  kLeastVarianceFactor,
  kUnmeasuredNoise,
  kBoneNoise,
  kProcessNoiseWidening,
  kAutocorrelatedError,
  kPersistentResiduals,
  kGapInflation,
  kAmbiguousRigCovariance,
  // Stated uncertainty of depth fits.
  kLowCoverage,
  kUnknownShape,
  kBodyErrorFactor,
  kPatchShare,
  kSurfaceWeight,
  kVarianceInflation,
  kRayNoise,
  // Repairs of tracks and of depth tracking.
  kOutlierRejection,
  kBodySides,
  kReversedBody,
  kPersonPoints,
  kRestartAfterGap,
  kRefitPoorFrames,
  kRecoverLostFrames,
  kSecondStart,
  // Audits of rigs.
  kSharedPlaces,
  kClockWidening,
  kViewSides,
  kSidesThroughout,
  kInconsistentCameras,
  kPersonShape,
  kWrongDepths,
  kCommonFault,
  kFarMove,
  kInconsistentViews,
  kCount,  ///< number of rules
};

/// Which rules of a fit are on. Each group of options of a fit holds a copy (FittingOptions::UseRules).
class Rules {
 public:
  bool on(FittingRule rule) const { return !off_.test(static_cast<std::size_t>(rule)); }
  void SwitchOff(FittingRule rule) { off_.set(static_cast<std::size_t>(rule)); }

  /// The option `without`: names of the rules that are off; an unknown name is refused with the known ones.
  void Declare(OptionVisitor& v);

 private:
  std::bitset<static_cast<std::size_t>(FittingRule::kCount)> off_;
};

/// Names of all rules in the option, in the order of the enum.
const std::vector<std::string>& FittingRuleNames();

}  // namespace mocurate
