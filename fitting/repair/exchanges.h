#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

// Steps of limbs between two observations, for exchanged limbs and bodies.
inline constexpr double kLimbSpeed = 1.5;       ///< m/s per axis, of a limb relative to the body's centre
inline constexpr double kMostSampleCost = 8.0;  ///< cost (negative log likelihood) at most of one sample: an outlier
inline constexpr double kStepGap_s = 0.25;      ///< longest time between two observations that form a step

/// A limb whose sides the tracker exchanged in frames [frame_begin, frame_end). `pairs`: left joints from the trunk
/// outwards.
struct LimbExchange {
  int frame_begin = 0;
  int frame_end = 0;
  std::vector<int> pairs;
  double margin = 0.0;  ///< log-likelihood ratio of the steps, exchanged against not exchanged
};

/// Exchanged left and right limbs, by a Viterbi search over time for arms and for legs. A state is the joint from which
/// outwards the sides are exchanged, or none. Costs:
/// - the distance of each joint from the last observation of its own or the other side, relative to the body's motion,
///   against noise and usual speed, with a cap; a side not observed lately costs the cap;
/// - the difference of bones from `bone_length` where exchanged and not exchanged joints meet;
/// - each change of state, and a little for each exchanged frame, so that the rarer state counts as exchanged.
/// Most frames are exchanged only where that is likelier by `least_margin`. Only steps count towards the margin: a
/// tracker may estimate wrong bone lengths for a long time. Limbs of one pair are skipped, as it may cross in a normal
/// movement. Sorted by frame; every margin is at least `least_margin`. `noise_sigma`: metres per axis.
std::vector<LimbExchange> FindExchanges(const SkeletonTracks& tracks, const std::vector<double>& bone_length,
                                        double noise_sigma, double least_margin);

}  // namespace mocurate
