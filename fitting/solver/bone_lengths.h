#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Bone lengths estimated from tracks. (J), metres.
struct BoneEstimate {
  std::vector<double> length;
  std::vector<int> samples;   ///< (J) observed lengths behind each; 0: inferred from the rest skeleton
  std::vector<double> sigma;  ///< (J) robust standard deviation over frames, metres; 0 without samples
  double scale = 1.0;         ///< size of the person over the rest skeleton's
};

/// Whether an observed joint is at exactly its parent's position, though the skeleton has a bone (of 1 cm or more)
/// between them. Trackers write this for unobserved joints.
bool IsAtParent(const SkeletonTracks& clip, int frame, int joint);

/// Whether any frame of any clip shows a joint elsewhere than at exactly its parent's position. (J)
std::vector<bool> ShownJoints(const std::vector<SkeletonTracks>& clips);

/// Robust distance between two joints over all clips, corrected for noise.
struct BoneDistance {
  double length = 0.0;      ///< metres
  double sigma = 0.0;       ///< robust standard deviation over frames, metres
  int samples = 0;          ///< frames that show both
  double confidence = 0.0;  ///< sum of squared confidences
};

/// Skips frames in which either end is at exactly its parent's position (unobserved). `white`: for each clip, the noise
/// of a typical sample per axis, metres (NoiseEstimate).
BoneDistance DistanceOver(const std::vector<SkeletonTracks>& clips, const std::vector<double>& white, int a, int b);

/// Median of the observed lengths of each bone over all clips of a person, corrected for noise and weighted by the
/// confidence of its ends. With sigma per axis at both ends, noise adds 4 sigma^2 to the median square of a length. A
/// bone with an unobserved parent (a root between the hips) follows from the distances between its observed siblings,
/// with the rest skeleton's directions. Bones over unobserved joints at a nearly constant distance (a trunk) have the
/// lengths with which the rest pose has that distance. Several chains that share trunk bones are solved together by
/// maximum likelihood. The other unobserved bones have rest length times `scale`. With `symmetric`, left and right have
/// equal lengths.
BoneEstimate EstimateBoneLengths(const std::vector<SkeletonTracks>& clips, const Skeleton& skeleton, bool symmetric);

}  // namespace mocurate
