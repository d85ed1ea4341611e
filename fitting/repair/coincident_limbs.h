#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Both sides of a limb in one place in frames [frame_begin, frame_end).
struct CoincidentLimbs {
  int frame_begin = 0;
  int frame_end = 0;
  std::vector<int> joints;  ///< that are not where they are said to be: knee or elbow and all that hangs from it, of
                            ///< the side that went over to the other, or of both where nothing tells which did
  double distance = 0.0;    ///< metres between the sides, the median of its frames
};

/// The body's volume separates knees, ankles, elbows and wrists: in recorded people by 22 cm and more
/// (arms) and 10 cm (legs side by side), while trackers that lose a limb set it on the other one. Found where both
/// pairs (the joint below the knee or elbow stands for ankle or wrist) lie within 3 cm and twice the noise, at most 6
/// cm, in five frames and for 0.15 s. A side that jumps there or back, beside what the other does, went over.
/// `noise_sigma` metres per axis. Sorted by limb, then by frame.
std::vector<CoincidentLimbs> FindMergedLimbs(const SkeletonTracks& tracks, double noise_sigma);

}  // namespace mocurate
