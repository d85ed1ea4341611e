#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

/// Covariance of each joint's frame orientation (3 x 3 in the joint's frame, rad^2; (J)) from the uncertain position of
/// each bone's end relative to its start: `variance` (J), m^2 per axis; 0: the bone has no information.
std::vector<Matrix3d> FrameOrientationByBones(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                              const std::vector<double>& variance);

/// Covariance of each joint's frame orientation between bodies (3 x 3 in the joint's frame, rad^2; (J)). Rotations
/// refer to a skeleton's rest pose, and the ends of people's bones vary by the standard deviations of body_sigma.h. The
/// bones at a joint therefore rotate its frame by that deviation over their ends' distance from the axis. Places of a
/// tracker's points that are not joints add their own. Only bones with both ends observed count. About a joint's only
/// bone there is no such rotation (that twist is in the prior), unless the bone ends in a hinge: then the carrying
/// angle of forearms and shins.
std::vector<Matrix3d> FrameOrientationCovariance(const TrackWindow& whole);

}  // namespace mocurate
