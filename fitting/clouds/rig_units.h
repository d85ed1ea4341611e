#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// Lengths of depth views that are misread.
struct MisreadLengths {
  double depth = 1.0;   ///< depths are so many times too long
  double places = 1.0;  ///< and so are the places of cameras
};

/// Whether depth makes a person of no person's size, or cameras stand so that none sees what others see, and the power
/// of ten that corrects it. Empty where all units are right, and where no factor corrects them. Errors of ReadFrame.
Expected<std::optional<MisreadLengths>> FindMisreadLengths(DepthRigSampler& sampler);

std::vector<DepthView> WithLengths(std::vector<DepthView> views, const MisreadLengths& misread);

/// "depths are 1000 times too long (millimetres read as metres)".
std::string WordsOf(const MisreadLengths& misread);

}  // namespace mocurate
