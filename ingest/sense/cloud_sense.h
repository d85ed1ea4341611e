#pragma once

#include <optional>
#include <string>

#include "ingest/sense/observe.h"

namespace mocurate {

/// "point_far", whose value is how far the farthest is, in the file's unit: points that are no part of what was
/// scanned. Farther from the middle (the median of each axis) than 20 times what nine points in ten are: an error of a
/// mesh; of a cloud a warning up to 1000 times, as depth cameras have a number for nothing seen. Where the cloud is a
/// whole person in `units` (empty: unknown), a warning of those farther than 2.5 m. The message names the first:
/// `file`, its line or number, its place.
std::optional<Finding> DoubtPoints(const ObservedCloud& cloud, const std::string& units, const std::string& file);

}  // namespace mocurate
