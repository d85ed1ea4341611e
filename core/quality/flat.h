#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

/// "flat_body" (error): all points of all frames lie in one plane, as image points do; value: their thickness over
/// their width, below 1e-4. Not checked for fewer than 5 points or 2 frames, or without valid samples.
std::vector<Finding> FindFlat(const TrackedPoints& points);

}  // namespace mocurate
