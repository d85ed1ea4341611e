#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Left and right of a limb at the same position in frames [frame_begin, frame_end).
struct CoincidentLimbs {
  int frame_begin = 0;
  int frame_end = 0;
  std::vector<int> joints;  ///< joints at a wrong position: knee or elbow and all joints below, of the side that jumped
                            ///< to the other, or of both when that is ambiguous
  double distance = 0.0;    ///< median distance of the sides, metres
};

/// In recorded people both elbows and wrists are 22 cm apart and more, both knees and ankles 10 cm. A tracker that
/// loses a limb places it on the other one. A limb is reported when both pairs lie within 3 cm and twice the noise, at
/// most 6 cm, in five frames and for 0.15 s. The pairs are knees and ankles, or elbows and wrists; the joint below the
/// knee or elbow stands for ankle or wrist. The side that jumps there or back, beyond the motion of the other, is the
/// wrong one. `noise_sigma`: metres per axis. Sorted by limb, then by frame.
std::vector<CoincidentLimbs> FindMergedLimbs(const SkeletonTracks& tracks, double noise_sigma);

}  // namespace mocurate
