#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Share [0, 1] of the pixels with a depth in one of two views of a sensor that are as deep in the other one, in the
/// first, the middle and the last frame; the least of the three, 0 where images are not of one size, negative where
/// none shows anything. Errors of ReadDepthImage.
Expected<double> DepthSimilarity(const DepthView& a, const DepthView& b);

}  // namespace mocurate
