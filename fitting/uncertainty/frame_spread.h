#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

/// By how much the frame of each joint is turned (3 x 3 in the joint's frame, rad^2; (J)) where the end of each bone
/// lies off its start by more or less than it should: `variance` (J) of that, m^2 per axis; 0: a bone that tells
/// nothing.
std::vector<Matrix3d> TurnsByBones(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                   const std::vector<double>& variance);

/// How far the frame of each joint lies from where the same rotation is on another body (3 x 3 in the joint's frame,
/// rad^2; (J)): rotations are counted from the rest pose of a skeleton, and people's bones end elsewhere by the spreads
/// of body_spread.h, so that the bones that start at a joint turn its frame by a spread over how far their ends lie
/// from the axis. Points of a tracker that are no joints lie elsewhere by their own spread too. Of bones with both ends
/// seen. About the only bone of a joint nothing turns it (that twist is in the prior) unless that bone ends in a hinge:
/// then by the angle at which people carry forearms and shins.
std::vector<Matrix3d> FrameSpreads(const TrackWindow& whole);

}  // namespace mocurate
