#pragma once

#include <vector>

#include "fitting/solver/bone_lengths.h"

namespace mocurate {

/// The skeleton with the person's own directions of bones that start at one joint, in that joint's frame. Angles
/// between them follow from the distances of their ends, which no rotation changes (classical scaling: the Gram matrix
/// of the bones is (b_i^2 + b_k^2 - d_ik^2) / 2); which of two mirror images it is, frames say where they agree. Of
/// what distances say and the rest skeleton, off by a quarter of the bones, the likeliest is taken: few or noisy
/// samples change little. How the whole lies in the joint's frame no position tells: as near to `skeleton` as turning
/// goes (orthogonal Procrustes). Where nobody sees the end of a bone, the next seen joint below it stands for it, as
/// long as one bone alone goes on and none swings against the next, and the bones between turn together. Where several
/// go on (a spine that nobody sees), what is seen beyond tells how the whole is pitched (TurnedToTrunk). Left as they
/// are: bones alone at a joint, of a joint that is never seen, and those with a bone that noise of one sample reaches
/// across. Lengths of rest offsets stay those of `skeleton`. With `symmetric`, both sides share distances. Directions
/// in whole 1e-4.
SkeletonPtr WithOwnDirections(const std::vector<SkeletonTracks>& clips, const SkeletonPtr& skeleton,
                              const BoneEstimate& bones, bool symmetric);

/// Whole 1e-4, as they are written down; the length stays.
Vector3d RoundedDirection(const Vector3d& offset);

}  // namespace mocurate
