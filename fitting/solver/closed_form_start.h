#pragma once

#include <vector>

#include "fitting/costs/pose_state.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Joints whose rotation moves a seen joint, or is recorded, or turns one whose rotation is: the others cannot be told
/// from evidence and stay in the rest pose. (J)
std::vector<bool> JointsWithEvidenceBelow(const SkeletonTracks& tracks);

/// Writes a pose for every frame into `state` without iteration. Tracks are filled in time and freed of single outliers
/// by a running median; then, from the frame that shows most joints forwards and backwards, from the root to the
/// leaves: rigid alignment (Kabsch) at joints with two or more seen neighbours below, smallest swing at joints with
/// one, identity at the rest. Of several neighbours those not seen within 0.25 s tell nothing. A root that is not seen
/// follows from the joints below it. Rotation vectors are unwrapped to the branch nearest the neighbouring frame, as
/// long as they stay below 1.5 pi (at 2 pi a rotation vector loses two degrees of freedom).
void ClosedFormStart(const SkeletonTracks& tracks, PoseState& state);

}  // namespace mocurate
