#pragma once

#include "core/quality/tracked_points.h"

namespace mocurate {

/// Stretches of one clip that appear in it twice, as when a writer stitches or flushes a buffer twice.
///   "repeated_stretch": the frames of the later one, equal to earlier frames in the same order to the last digit of
///                       all observed values; value: their number. The message gives the start of the earlier one.
/// At least 8 different poses: a motionless person on a coarse grid of values, in equal frames or between a few poses,
/// is not reported. A smooth motion that continues through both ends of the stretch is an authored loop and not
/// reported; motion with sensor noise is not smooth. Time n log n.
std::vector<Finding> FindRepeatedStretches(const TrackedPoints& points);

}  // namespace mocurate
