#pragma once

#include <optional>
#include <vector>

#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

/// A view that lists left as right throughout.
struct SidesThroughout {
  std::size_t view = 0;
  RigModel model;            ///< with its sides exchanged
  std::vector<double> cost;  ///< of the moments (CostOfMoments), so
  double confidence = 0.0;   ///< that it is better than as the model has it, and than any other view's exchange
};

/// The view whose sides, exchanged in all of the take, explain most of what `cost` (of the moments, under the model)
/// says that the model does not. Unlike another place of a camera an exchange has nothing to fit. Empty for fewer than
/// three views, whose wrong one is ambiguous, and where no exchange gets much better, surer than
/// `sure`.
std::optional<SidesThroughout> FindSidesThroughout(const RigSamples& samples, const RigModel& model,
                                                   const std::vector<double>& cost, double sure,
                                                   const TriangulationOptions& options);

}  // namespace mocurate
