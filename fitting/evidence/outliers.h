#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Median, axis by axis, of what is seen of a joint within 0.12 s of a frame, as many
/// samples before as after. Metres. The joint must be seen there.
Vector3d RunningMedian(const SkeletonTracks& tracks, int frame, int joint);

/// How far from where it should be a sample of a joint with this noise (metres, per axis) is taken for none of it: 10
/// sigma, at least 0.15 m.
double OutlierLimit(double sigma);

/// Samples that jump away and back: further from the running median (of at least three samples) than
/// OutlierLimit, and that and one and a half of the steps beside them, by their precision where they have one. Their
/// confidence is set to 0; returns which they are. (F*J)
std::vector<bool> RejectOutliers(SkeletonTracks& tracks, const std::vector<double>& joint_sigma);

}  // namespace mocurate
