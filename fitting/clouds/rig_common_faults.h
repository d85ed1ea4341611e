#pragma once

#include <optional>

#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// What is wrong with all depth views alike.
struct CommonFault {
  bool mirrored = false;        ///< images are turned over, x counts from the right
  double factor = 1.0;          ///< that corrects all depths
  double loss = 0.0;            ///< of the rig (MeanLoss) as given
  double corrected_loss = 0.0;  ///< after that correction
  double confidence = 0.0;
};

/// Depths that are all too long or too short by one factor (0.7 to 1.4), or images that are all mirrored, where views
/// that contradict each other as given (`losses`, LossOfSamples) then agree. Surfaces that each view has too far away,
/// or turned over, do not meet those of views from other sides; one person's size alone is no proof. Empty for fewer
/// than three views, of which two may be made to agree in many ways, and where neither explains most of the
/// contradiction.
std::optional<CommonFault> FindCommonFault(const ObservedRig& rig, const std::vector<double>& losses);

/// The same views, all depths times `factor`.
std::vector<DepthView> WithAllDepths(std::vector<DepthView> views, double factor);

}  // namespace mocurate
