#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

/// "units_change" (error): frames whose body is 10, 100 or 1000 times as large, or small, as that of most frames, in
/// any unit, with the same shape: distances that do not depend on the pose keep their proportions. Coinciding points
/// are not reported. Value: the factor. A pose alone changes the distance of points from their centre by a factor of 2
/// at most. Points with confidence 0 are not read, nor frames of fewer than five; spans separated by these frames only
/// are one.
std::vector<Finding> FindUnitChanges(const TrackedPoints& points);

}  // namespace mocurate
