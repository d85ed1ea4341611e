#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// A joint that is not where the body lets it be in frames [frame_begin, frame_end).
struct TornJoint {
  int joint = 0;
  int frame_begin = 0;
  int frame_end = 0;
  double distance = 0.0;  ///< metres, the most by which bones would have to be longer, or that it jumped
  bool jumped = false;    ///< told by its steps, not by bones
};

/// Joints that are off for three frames or longer, whatever they do there, in two ways:
/// - bones: with the bones cut that are longer than `bone_length` (J, metres) by 15 cm, half their length and six times
///   their noise, the largest part is the body; off is what even over joints left out cannot reach it. From there to
///   the jumps by which it came and went (at most half a second), since a place may happen to be at a bone's length;
/// - steps: it comes and goes by steps of 12 m/s and 0.3 m that bring it back to where it was, within
///   `longest_s`.
/// `noise_sigma` metres per axis. Sorted by joint, then by frame.
std::vector<TornJoint> FindTornJoints(const SkeletonTracks& tracks, const std::vector<double>& bone_length,
                                      double noise_sigma, double longest_s);

}  // namespace mocurate
