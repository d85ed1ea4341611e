#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {

/// Joints whose rotation moves an observed joint, is recorded, or moves a joint with a recorded rotation. The others
/// have no evidence and stay in the rest pose. (J)
std::vector<bool> JointsWithEvidenceBelow(const SkeletonTracks& tracks);

/// Writes a pose for every frame into `state` without iteration. Tracks are interpolated in time and filtered by a
/// running median. Then frames are solved from the one that shows most joints, forwards and backwards, each from the
/// root to the leaves: rigid alignment (Kabsch) at joints with two or more observed neighbours below, smallest swing
/// with one, identity without. Of several neighbours, those unobserved within 0.25 s are ignored. An unobserved root
/// follows from the joints below it. Rotation vectors are unwrapped to the branch nearest the neighbouring frame up to
/// 1.5 pi (at 2 pi a rotation vector loses two degrees of freedom).
void ClosedFormStart(const SkeletonTracks& tracks, PoseState& state);

}  // namespace mocurate
