#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// A fault common to all depth views.
struct CommonFault {
  bool mirrored = false;    ///< images are mirrored, x counts from the right
  double factor = 1.0;      ///< that corrects all depths
  double loss = 0.0;        ///< of the rig (MeanLoss) as given
  double loss_after = 0.0;  ///< and after the correction
  double confidence = 0.0;  ///< that it is better than as given (HeldOutCosts)
};

/// Finds depths that are all too long or too short by one factor (0.7 to 1.4), or images that are all mirrored.
/// Reported when the correction makes contradicting views (`losses`, LossOfSamples) agree. Surfaces that are too
/// distant or mirrored in each view do not meet those of views from other sides; the person's size alone is not used.
/// Empty for fewer than three views, because two can be made to agree in many ways. Empty when neither fault explains
/// most of the loss.
std::optional<CommonFault> FindCommonFault(const ObservedRig& rig, const std::vector<double>& losses);

/// The views with all depths times `factor`.
std::vector<DepthView> WithAllDepths(std::vector<DepthView> views, double factor);

/// Wrong units of depth views.
struct MisreadLengths {
  double depth = 1.0;   ///< factor by which depths are too long
  double places = 1.0;  ///< factor by which camera positions are too far
};

/// Tests whether depths give a person of implausible size, or whether camera positions leave views without overlap.
/// Returns the power of ten that corrects it. Empty where units are correct, or no power of ten helps. Errors of
/// ReadFrame.
Expected<std::optional<MisreadLengths>> FindMisreadLengths(DepthRigSampler& sampler);

std::vector<DepthView> WithLengths(std::vector<DepthView> views, const MisreadLengths& misread);

/// "depths are 1000 times too long (millimetres read as metres)".
std::string WordsOf(const MisreadLengths& misread);

/// Always corrected and certain: no other unit gives a person.
RigFault LengthsMisread(const MisreadLengths& misread);
/// A fault of all cameras of a rig; the audit sets confidence and correction.
RigFault FaultOfAll(const std::vector<std::string>& cameras, const CommonFault& common, const ObservedRig& rig);

}  // namespace mocurate
