#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/solver/bone_lengths.h"

namespace mocurate {

/// The skeleton with the person's own directions of bones that start at one joint, in that joint's frame. Angles
/// between them follow from the distances of their ends, which no rotation changes (classical scaling: the Gram matrix
/// of the bones is (b_i^2 + b_k^2 - d_ik^2) / 2). Frames decide between the two mirror images, where they agree. The
/// result is the maximum-likelihood combination of distances and rest skeleton (sigma: a quarter of the bones), so few
/// or noisy samples change little. Positions do not determine the orientation of the whole in the joint's frame: it is
/// as near to `skeleton` as possible (orthogonal Procrustes). For an unobserved end, the next observed joint below is
/// used, as long as each joint between has one bone and none swings; the bones between rotate together. Where several
/// bones continue (an unobserved spine), the observed joints beyond determine the pitch of the whole (AlignedToTrunk).
/// Unchanged: single bones at a joint, bones of a joint that is never observed, and those with a bone shorter than the
/// noise of one sample. Lengths of rest offsets stay those of `skeleton`. With `symmetric`, both sides share distances.
/// Directions are rounded to 1e-4.
SkeletonPtr WithOwnDirections(const std::vector<SkeletonTracks>& clips, const SkeletonPtr& skeleton,
                              const BoneEstimate& bones, bool symmetric);

/// Rounded to 1e-4, as in files; the length stays.
Vector3d RoundedDirection(const Vector3d& offset);

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
