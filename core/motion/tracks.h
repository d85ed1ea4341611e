#pragma once

#include "core/motion/clip.h"

namespace mocurate {

/// Unfitted tracks as a joints-only motion on a skeleton: the baseline that a fit is compared with. Points are matched
/// by name and synonym. Missing observations are interpolated linearly in time and held at both ends; their states are
/// those of GapStates. A root that no track gives is the midpoint of the hips (state kInferred). Error kInconsistent
/// names the joints that no track gives.
Expected<Motion> MotionFromTracks(const JointTracks& tracks, const SkeletonPtr& skeleton, FrameRate rate,
                                  double max_gap_s);

}  // namespace mocurate
