#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Factors on the variances of long unobserved samples, 1 elsewhere: of positions and of rotations, (F*J).
struct GapInflation {
  std::vector<double> position;
  std::vector<double> rotation;
};

/// A long gap contains one movement (a step, a rotation), not many independent ones: errors grow with its length, a
/// random walk's with the root of it. Applies from gaps of 0.6 s, at most a factor of four on sigma, to a joint
/// unobserved there. A rotation has the factor of the joints below that determine it; a joint that is never observed,
/// that of the joints above and below. Calibrated on synthetic takes (`bench_studio_fits` with gap=SECONDS).
GapInflation FindGapInflation(const SkeletonTracks& tracks);

}  // namespace mocurate
