#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Standard deviation of tracks per axis, of all joints together, metres.
struct NoiseEstimate {
  double sigma = 0.0;
  double white = 0.0;    ///< part that is independent from frame to frame
  bool measured = true;  ///< false: too few samples, sigma is assumed
};

/// Noise estimated from the tracks by medians (1.4826 MAD, gross errors excluded): the larger of two
/// estimates: departure of a frame from the line between its two neighbours in time (white noise, bounded by the
/// departures of bone lengths, which motion does not change); departure of observed bones from `bone_length` (J, or
/// empty: their own median), which includes wobble that a tracker has smoothed. Never below 1 mm, also without any
/// noise. With one or two frames 20 mm are assumed.
NoiseEstimate EstimateNoise(const SkeletonTracks& tracks, const std::vector<double>& bone_length);

/// Covariance of an observed sample in units of sigma^2: its precision's inverse; the identity without precisions.
Matrix3d UnitCovariance(const SkeletonTracks& tracks, int frame, int joint);

/// Median, axis by axis, of a joint's observed samples within 0.12 s of a frame, as many before as after. Metres. The
/// joint must be observed in the frame.
Vector3d RunningMedian(const SkeletonTracks& tracks, int frame, int joint);

/// Distance from its expected position beyond which a sample of this noise (metres, per axis) is an outlier: 10 sigma,
/// at least 0.15 m.
double OutlierLimit(double sigma);

/// Rejects samples that jump away and back: distance from the running median (of at least three samples) above
/// OutlierLimit and above one and a half of the neighbouring steps, weighted by precisions if known. Sets their
/// confidence to 0; returns the rejected samples. (F*J)
std::vector<bool> RejectOutliers(SkeletonTracks& tracks, double sigma);

}  // namespace mocurate
