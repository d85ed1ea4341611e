#pragma once

#include "core/motion/clip.h"

namespace mocurate {

/// Share [0, 1] of the keypoints that two views of one place list at the same moments, of entries that are nearest to
/// each other, that both have in one direction, to within 3 % of the entry's extent; negative where they list none.
double KeypointSimilarity(const KeypointView& a, const KeypointView& b);

}  // namespace mocurate
