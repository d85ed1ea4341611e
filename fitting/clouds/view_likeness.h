#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Share [0, 1] of pixels with equal depth in two views of a sensor, among those with a depth in one of them. The
/// lowest over the first, middle and last frame; 0 for images of different size, negative when both are empty. Errors
/// of ReadDepthImage.
Expected<double> DepthSimilarity(const DepthView& a, const DepthView& b);

}  // namespace mocurate
