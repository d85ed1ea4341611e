#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Standard deviation of tracks per axis, metres.
struct NoiseEstimate {
  double sigma = 0.0;               ///< of all joints together
  double white = 0.0;               ///< part that is independent from frame to frame
  std::vector<double> joint_sigma;  ///< (J); sigma for joints with too few samples
  bool measured = true;             ///< no: too few samples of all joints together, sigma is assumed
};

/// Noise from the tracks themselves, by medians (1.4826 MAD, gross errors left out), the larger of two estimates per
/// joint: what a frame departs from the line between its two neighbours in time (white noise; no more than lengths of
/// bones depart from theirs, which motion does not change, however fast), and what observed bones
/// depart from `bone_length` (J, or empty: from their own median), which also sees wobble that a tracker has smoothed.
/// Never below 1 mm, which is also what a capture without any noise gets. Of one or two frames, whose own bones say
/// nothing, 20 mm are assumed.
NoiseEstimate EstimateNoise(const SkeletonTracks& tracks, const std::vector<double>& bone_length);

/// Covariance of a seen sample in units of sigma^2: its precision's inverse; the identity where tracks have none.
Matrix3d UnitCovariance(const SkeletonTracks& tracks, int frame, int joint);

}  // namespace mocurate
