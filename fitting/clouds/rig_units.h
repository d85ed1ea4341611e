#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/observed_rig.h"

namespace mocurate {

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

}  // namespace mocurate
