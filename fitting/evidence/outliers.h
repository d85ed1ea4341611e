#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

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
