#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// A limb whose left and right keypoints one view exchanges in frames [frame_begin, frame_end). Its own inverse.
struct SideExchange {
  std::size_t view = 0;
  std::string limb;  ///< "arms", "legs"
  int frame_begin = 0;
  int frame_end = 0;
  double margin = 0.0;  ///< log-likelihood ratio, exchanged against not exchanged
};

/// (K) index of the mirror keypoint ("left_knee" of "right_knee"), or its own index.
std::vector<std::size_t> OtherSides(const std::vector<std::string>& names);

/// Finds left and right arms or legs that a view exchanges, by a Viterbi search over time with two states per view and
/// limb. A state costs the distance of the view's detections from the points of all views (heavy-tailed, `noise_px`); a
/// change of state has a cost. Only where points are triangulated, so for three and more views. `names` (K):
/// "left_knee" and "right_knee" are a pair. Every margin is at least `least_margin`.
std::vector<SideExchange> FindSideExchanges(const std::vector<ViewKeypoints>& views, const TriangulatedTracks& points,
                                            const std::vector<std::string>& names, double noise_px,
                                            double least_margin);

/// Undoes the exchanges.
void ExchangeSides(const std::vector<SideExchange>& exchanges, const std::vector<std::string>& names,
                   std::vector<ViewKeypoints>& views);

/// A view that lists left as right in all frames.
struct SidesThroughout {
  std::size_t view = 0;
  RigModel model;            ///< with its sides exchanged
  std::vector<double> cost;  ///< of the moments (CostOfMoments), with its sides exchanged
  double confidence = 0.0;   ///< that it is better than the model, and than any other view's exchange
};

/// The view whose sides, exchanged in all frames, explain most of the model's `cost` (of the moments). Unlike a camera
/// move, an exchange has no free parameters. Empty for fewer than three views (of two the wrong one is ambiguous), and
/// without a clear improvement of confidence above `sure`.
std::optional<SidesThroughout> FindSidesThroughout(const RigSamples& samples, const RigModel& model,
                                                   const std::vector<double>& cost, double sure,
                                                   const TriangulationOptions& options);

}  // namespace mocurate
