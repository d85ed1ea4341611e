#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// The whole body with left and right exchanged in frames [frame_begin, frame_end).
struct BodyExchange {
  int frame_begin = 0;
  int frame_end = 0;
  bool rarer = false;  ///< at most half of the chain's frames are exchanged
  double confidence = 0.0;
  std::string evidence;  ///< text of the evidence
};

/// Spans in which left and right of the whole body are exchanged. Frames without a gap longer than 0.25 s form a chain.
/// Within a chain, a change of sides shows as a jump of all pairs to each other's positions. It is accepted when it is
/// likelier by `least_margin` (difference of log likelihoods) and almost no pair contradicts it. Anatomy decides which
/// state is correct: knees bend backwards when sides are exchanged (MeasureHandedness), and the nose lies in front of
/// the ears. Without a result from anatomy, the longer state is correct. `noise_sigma`: metres per axis. Sorted by
/// frame. A mirrored world looks like sides that are exchanged in all frames.
std::vector<BodyExchange> FindBodyExchanges(const SkeletonTracks& tracks, double noise_sigma, double least_margin);

/// Whether anatomy (knees, feet, hands, face) shows left and right of the whole body exchanged. Empty where it gives no
/// result or frames are too few.
std::optional<bool> SidesExchangedByAnatomy(const SkeletonTracks& tracks);

/// Whether the spans contain every frame that observes a joint.
bool CoverAll(const std::vector<BodyExchange>& exchanges, const SkeletonTracks& tracks);

/// Left joints that have a mirror joint, from the trunk outwards.
std::vector<int> LeftJoints(const Skeleton& skeleton);

/// Exchanges positions, confidences and precisions of left joints and their mirror joints in frames [begin, end). Its
/// own inverse.
void ExchangeJoints(const std::vector<int>& left, int begin, int end, SkeletonTracks& tracks);

}  // namespace mocurate
