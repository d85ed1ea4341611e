#pragma once

#include <optional>

#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// A fault common to all depth views.
struct CommonFault {
  bool mirrored = false;    ///< images are mirrored, x counts from the right
  double factor = 1.0;      ///< that corrects all depths
  double loss = 0.0;        ///< of the rig (MeanLoss) as given
  double loss_after = 0.0;  ///< and after the correction
  double confidence = 0.0;
};

/// Finds depths that are all too long or too short by one factor (0.7 to 1.4), or images that are all mirrored.
/// Reported when the correction makes contradicting views (`losses`, LossOfSamples) agree. Surfaces that are too
/// distant or mirrored in each view do not meet those of views from other sides; the person's size alone is not used.
/// Empty for fewer than three views, because two can be made to agree in many ways. Empty when neither fault explains
/// most of the loss.
std::optional<CommonFault> FindCommonFault(const ObservedRig& rig, const std::vector<double>& losses);

/// The views with all depths times `factor`.
std::vector<DepthView> WithAllDepths(std::vector<DepthView> views, double factor);

}  // namespace mocurate
