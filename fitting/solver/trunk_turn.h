#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Bones that start at one joint, as a person has them.
struct StarOfBones {
  int joint = 0;
  std::vector<int> ends;     ///< seen joints that they end at
  Eigen::Matrix3Xd offsets;  ///< (3, ends) from the joint to each in the joint's frame, metres
};

/// The seen joints and landmarks that stand for what begins with the unseen joint `child`: all that are reached over
/// the fewest bones. Empty where nothing is seen below it. `seen`: (J) ShownJoints.
std::vector<int> SeenBeyond(int child, const Skeleton& skeleton, const std::vector<bool>& seen);

/// The offsets turned about the axis across the body (through mirror partners) so that the middle of `trunk` lies, in
/// the median of the frames that show it and the star, where the rest pose of the skeleton has it: hips alone do not
/// tell how the pelvis is pitched. As they are where no frame shows all, no two ends are mirror partners, or all lie no
/// farther than `across` from that axis, metres: what noise of one sample reaches.
Eigen::Matrix3Xd TurnedToTrunk(const StarOfBones& star, const std::vector<int>& trunk,
                               const std::vector<SkeletonTracks>& clips, double across);

}  // namespace mocurate
