#pragma once

#include <optional>
#include <vector>

#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_uncertainty.h"

namespace mocurate {

/// Termination of a chain that did not settle.
inline constexpr const char* kUnsettledChain =
    "all frames together are matched and solved ten times, and joints still move by more than a millimetre";

/// Result of a chain.
struct SmoothedChain {
  std::vector<PosePosterior> uncertainty;  ///< of each of its frames; empty ones without options.uncertainty
  std::optional<Error> undetermined{};     ///< why there is no uncertainty (FactorInformation)
  bool settled = true;                     ///< the joints of all frames, before the matchings ended
  double initial_cost = 0.0;               ///< of all parts
  double final_cost = 0.0;                 ///< at the last matching that was solved
};

/// Fits the frames of a chain together from the poses in the state: the terms of each frame (`held` and `widening` are
/// not used), and process noise between neighbours at most 0.4 s apart. The standard deviation that weighs a frame's
/// points is that of the first matching. Points are matched anew after each step that lowers the cost, until the joints
/// settle. Writes the poses to the state. Uncertainty is from the same equations (selected inversion): that
/// of a smoother, no frame is taken as known, and includes what a body that is not the person's does. `chain` ascends
/// in frames; `time_s` (F). Memory is bounded by parts of 300 frames, fitted with 30 frames on either side. Errors
/// of Solve.
Expected<SmoothedChain> SmoothChain(const CapsuleBody& body, const std::vector<FusedCloud>& clouds,
                                    const std::vector<FrameFit>& chain, const std::vector<double>& time_s,
                                    const PointCloudOptions& options, PoseState& state);

}  // namespace mocurate
