#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/cloud_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/clouds/frame_terms.h"
#include "fitting/costs/pose_state.h"
#include "fitting/options.h"

namespace mocurate {

/// Result of a solve.
struct CapsuleFitOutcome {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  double sigma = 0.0;  ///< m, robust standard deviation of the distances, used to weight the points
  double moved = 0.0;  ///< m, mean movement of the joints in the last matching
  int iterations = 0;  ///< number of matchings
  bool converged = false;
};

/// Settings for the fit of one frame.
struct FrameFit {
  int frame = 0;
  std::vector<FixedNeighbourFrame> held;      ///< fixed neighbouring frames
  double widening = 1.0;                      ///< factor on max_distance in the first matching, decreasing later
  int iterations = 40;                        ///< matchings, at most
  std::vector<JointObservation> joints = {};  ///< joint positions from other modalities
  const PoseGaussian* pose = nullptr;         ///< of other evidence, which has priors of its joints already
  double point_weight = 1.0;                  ///< factor on the weight of points: below 1 when the whole body is off
};

/// Fits one frame from the pose in the state. Alternates matching and solving until the joints converge. Error
/// kInconsistent if the solver fails.
Expected<CapsuleFitOutcome> FitCloudFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                          PoseState& state, const PointCloudOptions& options);

/// Mean distance of a frame's points to the body in metres, each at most `max_distance`, to compare starts. Needs
/// Update.
double MeanDistance(const CapsuleBody& body, const FusedCloud& cloud, const PoseState& state, int frame,
                    double max_distance);

/// Cost of a pose: distances of all points weighted with one sigma (unmatched points at their limit), priors, and legs
/// inside the upper body. Compares poses of one cloud. Needs Update.
double PoseCost(const CapsuleBody& body, const FusedCloud& cloud, PoseState& state, int frame,
                const PointCloudOptions& options);

}  // namespace mocurate
