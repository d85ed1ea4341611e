#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// A limb whose sides the tracker exchanged in frames [frame_begin, frame_end): `pairs` are the left joints from the
/// trunk outwards.
struct LimbExchange {
  int frame_begin = 0;
  int frame_end = 0;
  std::vector<int> pairs;
  double margin = 0.0;  ///< by how much likelier the steps are than without, as a difference of log likelihoods
};

/// Left and right limbs that are exchanged, by a Viterbi search over time for each kind of limb (arms, legs). A state
/// says from which joint outwards the sides are exchanged, or that they are not. It costs how far the joints are from
/// where they, or the other side's, were seen last (against noise and everyday speed, beside what the body goes; a
/// gross jump counts only so much, and that much too to come from a side that was not seen lately), what bones differ
/// from `bone_length` where exchanged and not exchanged joints meet, each change of state, and a little per exchanged
/// frame, so that of two states that only differ in name the rarer one is the exchange: most frames are exchanged only
/// where that is likelier by `least_margin`. Bones alone, which a tracker may get wrong for long, make no exchange: the
/// margin is of the steps. Limbs of fewer than two pairs are not judged: one pair crosses in any clap. Sorted by frame;
/// every margin is at least `least_margin`. `noise_sigma` metres per axis.
std::vector<LimbExchange> FindExchanges(const SkeletonTracks& tracks, const std::vector<double>& bone_length,
                                        double noise_sigma, double least_margin);

}  // namespace mocurate
