#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

/// "axes_change" (error): frames whose axes differ from those of most frames, in any unit. Between two frames the body
/// is rotated or mirrored to other signs or another order of the axes, and stays so. Changing the axes back restores
/// the pose about the body's centre. Value: 1 for a rotation, -1 for a mirror image. Points with confidence 0 are not
/// read. Left-right exchanges by a tracker are left to FindSwaps. A lost body is followed for some frames; after these
/// the comparison restarts. Where both parts are about equally long, the message states that the right one is
/// ambiguous.
std::vector<Finding> FindAxesChanges(const TrackedPoints& points);

}  // namespace mocurate
