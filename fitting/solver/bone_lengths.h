#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Bone lengths read from tracks. (J), metres.
struct BoneEstimate {
  std::vector<double> length;
  std::vector<int> samples;    ///< (J) observed lengths behind each; 0: inferred from the rest skeleton
  std::vector<double> spread;  ///< (J) robust standard deviation over frames, metres; 0 without samples
  double scale = 1.0;          ///< of the person against the rest skeleton
};

/// Whether a seen joint stands exactly where its parent does, though the skeleton has a bone (of 1 cm or more) between
/// them: what trackers write who do not see it.
bool StandsForAnother(const SkeletonTracks& clip, int frame, int joint);

/// Which joints any frame of any clip shows, elsewhere than exactly where their parent is. (J)
std::vector<bool> ShownJoints(const std::vector<SkeletonTracks>& clips);

/// Robust distance between two joints over all clips, freed of what noise adds.
struct BoneDistance {
  double length = 0.0;  ///< metres
  double spread = 0.0;  ///< robust standard deviation over frames, metres
  int samples = 0;      ///< frames that show both
  double sure = 0.0;    ///< sum of the squares of their confidence
};

/// Frames in which either end stands exactly where its parent does are left out: it was not seen there. `white`: of
/// each clip, the noise of a typical sample per axis, metres (NoiseEstimate).
BoneDistance DistanceOver(const std::vector<SkeletonTracks>& clips, const std::vector<double>& white, int a, int b);

/// Median of the observed lengths of each bone, freed of what noise adds (with noise of sigma per axis at both ends the
/// median square of a length is longer by 4 sigma^2) and weighted by how sure its ends are. Several clips of one person
/// count together. A bone whose parent is never seen (a root between the hips) follows from the distances between its
/// seen siblings, with the rest skeleton's directions. Bones over unseen joints between two that are seen, at a
/// distance that hardly changes (a trunk), have the lengths with which it is that of the rest pose; where several such
/// ways share bones of a trunk, those that make all likeliest. The other unseen bones have rest length times `scale`.
/// With `symmetric`, left and right share a length.
BoneEstimate EstimateBoneLengths(const std::vector<SkeletonTracks>& clips, const Skeleton& skeleton, bool symmetric);

/// The same length on both sides, weighted by `weight` (J).
void MakeSymmetric(const Skeleton& skeleton, const std::vector<double>& weight, std::vector<double>& length);

}  // namespace mocurate
