#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

/// "axes_change" (error) of frames whose axes are not those of most frames, in whatever unit: between two frames the
/// body is turned or mirrored to other signs or another order of the axes, and stays so, which no body does; what it
/// is like about its middle is then that of the frame before once the axes are changed back. Value: 1 where the body is
/// turned, -1 where it is mirrored. Points with confidence 0 are not read. Sides that a tracker exchanged, which a
/// mirror resembles, are left to FindSwaps. A body that is lost or strays is followed for some frames; beyond these it
/// starts anew. Of parts about as long the message says that the clip does not tell which is right.
std::vector<Finding> FindAxesChanges(const TrackedPoints& points);

}  // namespace mocurate
