#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Factors on the variances of what is not seen for long, 1 elsewhere: of positions and of rotations, (F*J).
struct UnseenGrowth {
  std::vector<double> position;
  std::vector<double> rotation;
};

/// What a person does in a long gap is one thing (a step, a turn), not many that are independent: errors grow with its
/// length, the walk's with its root. From gaps of 0.6 s on, four times at most, of a joint that is not seen there; a
/// rotation's by the joints below that tell it, a joint's that the tracks never show by the joints above and below.
/// Calibrated on synthetic takes (`bench_studio_fits` with gap=SECONDS, where nobody is seen).
UnseenGrowth GrowthOfUnseen(const SkeletonTracks& tracks);

}  // namespace mocurate
