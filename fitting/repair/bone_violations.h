#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// A joint whose position contradicts the rest of the body in frames [frame_begin, frame_end).
struct BoneViolation {
  int joint = 0;
  int frame_begin = 0;
  int frame_end = 0;
  double distance = 0.0;  ///< metres: largest excess over the bone length, or length of the jump
  bool jumped = false;    ///< found by its steps, not by bone lengths
};

/// Joints in a wrong position for three frames or longer. Two tests:
/// - Bone lengths. Bones longer than `bone_length` (J, metres) by 15 cm, half their length and six times the noise are
///   cut. The largest remaining part is the body; a violation cannot be reached from it, even across unobserved joints.
///   The span extends to the jumps at its start and end, at most half a second away, as a wrong position may lie at a
///   bone's length.
/// - Steps. The joint leaves and returns within `longest_s` by jumps: steps of 0.3 m that are faster than 12 m/s or
///   four times the steps around them. Either it returns to its earlier position and its bone lengths are no better in
///   between than around, or they are wrong only in between. In the second case, and within 0.35 s of a jump too fast
///   for a hand, an end of the clip counts as a jump. Jumps of most joints together are a move of the person.
/// `noise_sigma`: metres per axis. Sorted by joint, then by frame.
std::vector<BoneViolation> DetectBoneViolations(const SkeletonTracks& tracks, const std::vector<double>& bone_length,
                                                double noise_sigma, double longest_s);

}  // namespace mocurate
