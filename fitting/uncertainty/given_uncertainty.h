#pragma once

#include "core/motion/motion.h"

namespace mocurate {

/// A motion fitted to the joints of a given one is not more certain than that. Adds the given motion's stated
/// covariances to those of `fitted`, which are relative to the given joints: of the same joints, else of the nearest
/// parent that it has. Standard deviations of rotations likewise, for joints that both have. A sample that the given
/// motion interpolated or inferred does not count as observed. Without stated uncertainties nothing changes. Both have
/// the same frames; skeletons may differ.
void AddGivenUncertainty(const Motion& given, Motion& fitted);

}  // namespace mocurate
