#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/cloud_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/clouds/frame_terms.h"
#include "fitting/costs/pose_state.h"
#include "fitting/options.h"

namespace mocurate {

/// What a solve came to.
struct CapsuleFitOutcome {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  double sigma = 0.0;  ///< m, robust spread of the distances that the points were weighted with
  double moved = 0.0;  ///< m, mean move of the joints in the last matching
  int iterations = 0;  ///< of matching
  bool converged = false;
};

/// How one frame is fitted.
struct FrameFit {
  int frame = 0;
  std::vector<FixedNeighbourFrame> held;  ///< frames beside it
  double widening = 1.0;  ///< the first matching looks this many times farther than max_distance, later ones less
  int iterations = 40;    ///< of matching, at most
  std::vector<JointObservation> joints = {};  ///< what other evidence says
  double trust = 1.0;  ///< factor on the weight of points: below 1 where the body errs as a whole
};

/// Fits one frame from the pose that stands in the state, matching and solving in turn until the joints rest. Error
/// kInconsistent if the solver fails.
Expected<CapsuleFitOutcome> FitCloudFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                          PoseState& state, const PointCloudOptions& options);

/// Mean distance of a frame's points to the body in metres, each at most `max_distance`: compares starts. Needs Update.
double MeanDistance(const CapsuleBody& body, const FusedCloud& cloud, const PoseState& state, int frame,
                    double max_distance);

/// What a pose costs on its own: distances of all points weighted with one sigma, those of points without a match at
/// their limit, the priors, and legs that stand within the upper body. Compares poses of one cloud. Needs Update.
double PoseCost(const CapsuleBody& body, const FusedCloud& cloud, PoseState& state, int frame,
                const PointCloudOptions& options);

}  // namespace mocurate
