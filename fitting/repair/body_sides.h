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
  bool rarer = false;  ///< of the frames that steps join with it most are as they should be
  double confidence = 0.0;
  std::string evidence;  ///< in words
};

/// Spans in which left and right of the whole body are exchanged. Within frames that steps join (no gap of 0.25 s) a
/// change of sides shows in the steps: all pairs jump to each other's places, likelier by `least_margin` (difference of
/// log likelihoods) and with hardly a pair against it. Which of both states is right anatomy tells (MeasureHandedness,
/// and the face, that lies before the ears): of a body with its sides exchanged the knees bend backwards. Where
/// anatomy does not tell, the longer state is right. `noise_sigma` metres per axis. Sorted by frame. A mirrored world
/// looks the same as exchanged sides throughout.
std::vector<BodyExchange> FindBodyExchanges(const SkeletonTracks& tracks, double noise_sigma, double least_margin);

/// Whether left and right of the whole body are exchanged as anatomy has it (knees, feet, hands, the face); nothing
/// where it does not tell, or of few frames.
std::optional<bool> SidesExchangedByAnatomy(const SkeletonTracks& tracks);

/// Whether nothing is seen outside the spans.
bool CoverAll(const std::vector<BodyExchange>& exchanges, const SkeletonTracks& tracks);

/// Left joints of the skeleton that have a partner, from the trunk outwards.
std::vector<int> LeftJoints(const Skeleton& skeleton);

/// Exchanges what is said of left joints and of their partners in frames [begin, end). Its own inverse.
void ExchangeJoints(const std::vector<int>& left, int begin, int end, SkeletonTracks& tracks);

}  // namespace mocurate
