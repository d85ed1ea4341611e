#pragma once

#include <string>
#include <vector>

#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// A limb whose left and right keypoints one view lists the wrong way round in frames [frame_begin, frame_end). Its own
/// inverse.
struct SideExchange {
  std::size_t view = 0;
  std::string limb;  ///< "arms", "legs"
  int frame_begin = 0;
  int frame_end = 0;
  double margin = 0.0;  ///< by how much likelier it is, as a difference of log likelihoods
};

/// (K) index of the keypoint of the other side ("left_knee" of "right_knee"), or its own.
std::vector<std::size_t> OtherSides(const std::vector<std::string>& names);

/// Left and right arms or legs that a view exchanges, by a search over time (Viterbi, two states per view and limb): a
/// state costs what the view's detections depart from the points of all views (heavy tails, `noise_px`), a change of
/// state has its price. Only where points are found, which most views agree on: of two views nothing is said. `names`
/// (K): "left_knee" and "right_knee" are a pair. Every margin is at least `least_margin`.
std::vector<SideExchange> FindSideExchanges(const std::vector<ViewKeypoints>& views, const TriangulatedTracks& points,
                                            const std::vector<std::string>& names, double noise_px,
                                            double least_margin);

/// Exchanges back what was exchanged.
void ExchangeSides(const std::vector<SideExchange>& exchanges, const std::vector<std::string>& names,
                   std::vector<ViewKeypoints>& views);

}  // namespace mocurate
