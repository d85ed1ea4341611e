#pragma once

#include "core/quality/tracked_points.h"

namespace mocurate {

/// Stretches of one clip that stand in it twice, as a writer that stitches or flushes a buffer twice leaves them.
///   "repeated_stretch": the frames of the later one, equal to earlier frames in the same order to the last digit of
///                       all that is seen; value their number, the message says where the earlier one begins.
/// At least 8 different poses: a person who stands on a coarse grid of values, in a row of equal frames or between a
/// few poses, repeats nothing. A smooth motion that goes on through both ends of the stretch as within it is a loop
/// that was made so, and no finding; a sensor's noise is no smooth motion. Time n log n.
std::vector<Finding> FindRepeatedStretches(const TrackedPoints& points);

}  // namespace mocurate
