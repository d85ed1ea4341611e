#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// A joint that is not where the body lets it be in frames [frame_begin, frame_end).
struct BoneViolation {
  int joint = 0;
  int frame_begin = 0;
  int frame_end = 0;
  double distance = 0.0;  ///< metres, the most by which bones would have to be longer, or that it jumped
  bool jumped = false;    ///< detected by its steps, not by bones
};

/// Joints that are off for three frames or longer, whatever they do there, in two ways:
/// - bones: with the bones cut that are longer than `bone_length` (J, metres) by 15 cm, half their length and six times
///   their noise, the largest part is the body; off is what even over joints excluded cannot reach it. From there to
///   the jumps by which it came and went (at most half a second), since a place may happen to be at a bone's length;
/// - steps: it comes and goes, within `longest_s`, by jumps: steps of 0.3 m, of 12 m/s or four times as fast as those
///   right before and after. They bring it back to where it was and its bones are not better between them than around,
///   or its bones are wrong between them and right around. The clip's ends stand for a jump in the latter, and in 0.35
///   s next to a jump that no hand makes. Where most joints jump together it is the person who is elsewhere.
/// `noise_sigma` metres per axis. Sorted by joint, then by frame.
std::vector<BoneViolation> DetectBoneViolations(const SkeletonTracks& tracks, const std::vector<double>& bone_length,
                                                double noise_sigma, double longest_s);

}  // namespace mocurate
