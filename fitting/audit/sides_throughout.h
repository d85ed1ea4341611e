#pragma once

#include <optional>
#include <vector>

#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

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
