#pragma once

#include "core/motion/motion.h"

namespace mocurate {

/// A motion that was fitted to the joints of a given one knows no more than that one did. Adds to the covariances of
/// `fitted`, which are against the given joints, those that the given motion states of the same joints (of the nearest
/// parent that it has, for others); standard deviations of rotations likewise, of joints that both have. A sample that
/// the given motion interpolated or inferred is no observed one. A given motion that states nothing changes nothing.
/// Both of the same frames; skeletons may differ.
void AddGivenUncertainty(const Motion& given, Motion& fitted);

}  // namespace mocurate
