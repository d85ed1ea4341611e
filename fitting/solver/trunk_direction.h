#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// A person's bones that start at one joint.
struct StarOfBones {
  int joint = 0;
  std::vector<int> ends;     ///< observed joints at their ends
  Eigen::Matrix3Xd offsets;  ///< (3, ends) from the joint to each in the joint's frame, metres
};

/// The observed joints and landmarks that represent the bones beyond the unobserved joint `child`: all that are reached
/// over the fewest bones. Empty where nothing is observed below it. `seen`: (J) ShownJoints.
std::vector<int> ObservedBeyond(int child, const Skeleton& skeleton, const std::vector<bool>& seen);

/// The offsets rotated about the axis across the body (through mirror partners), so that the middle of `trunk` is where
/// the rest pose has it, in the median of the frames that show it and the star. Hips alone do not determine the
/// pelvis's pitch. Unchanged where no frame shows all, no two ends are mirror partners, or all ends lie within `across`
/// (noise of one sample, metres) of that axis.
Eigen::Matrix3Xd AlignedToTrunk(const StarOfBones& star, const std::vector<int>& trunk,
                                const std::vector<SkeletonTracks>& clips, double across);

}  // namespace mocurate
