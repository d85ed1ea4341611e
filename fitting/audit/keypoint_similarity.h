#pragma once

#include "core/motion/clip.h"

namespace mocurate {

/// Share [0, 1] of keypoints with equal directions in two views of one place, to within 3 % of the entry's extent.
/// Compares the nearest entries at the same moments, by keypoints that both list. Negative without such keypoints.
double KeypointSimilarity(const KeypointView& a, const KeypointView& b);

}  // namespace mocurate
