#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/cloud_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/costs/pose_state.h"
#include "fitting/options.h"

namespace mocurate {

/// What a solve came to.
struct CapsuleFitOutcome {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  double sigma = 0.0;  ///< m, robust spread of the distances that the points were weighted with
  int iterations = 0;  ///< of matching
  bool converged = false;
};

/// Fits one frame from the pose that stands in the state, matching and solving in turn. With `after_previous` the frame
/// before is held and joins through the walks of the options over `frame_seconds`. `clouds` (F). Error kInternal if the
/// solver fails.
Expected<CapsuleFitOutcome> FitCloudFrame(const FleshBody& body, const std::vector<FusedCloud>& clouds,
                                          PoseState& state, int frame, bool after_previous, double frame_seconds,
                                          const PointCloudOptions& options);

/// Mean distance of a frame's points to the body in metres, each at most `max_distance`: compares starts. Needs Update.
double MeanDistance(const FleshBody& body, const FusedCloud& cloud, const PoseState& state, int frame,
                    double max_distance);

}  // namespace mocurate
