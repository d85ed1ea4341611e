#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

/// "units_change" (error) of frames whose body is 10, 100 or 1000 times as large, or small, as that of most frames, in
/// whatever unit, and of the same shape: distances that poses leave alone keep their proportions; points that fell into
/// one place are no body of another unit. Value: how many times. A pose alone changes how far points are from their
/// middle by a factor of 2 at most. Points with confidence 0 are not read, nor frames of fewer than five; spans that
/// follow each other but for such frames are one.
std::vector<Finding> FindUnitChanges(const TrackedPoints& points);

}  // namespace mocurate
