#pragma once

#include <vector>

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

}  // namespace mocurate
