#pragma once

#include <vector>

#include "fitting/clouds/cloud_body.h"
#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// A point and its matched capsule.
struct CloudMatch {
  int point = 0;
  int capsule = 0;
  double distance = 0.0;  ///< m, signed
};

/// Nearest capsule of every point within `max_distance`, in the order of the points. A capsule whose surface normal
/// differs from the point's counts as farther. Needs PoseState::Update of the frame.
std::vector<CloudMatch> MatchPoints(const CapsuleBody& body, const PoseState& state, int frame, const FusedCloud& cloud,
                                    double max_distance);

/// Robust standard deviation of distances about zero, at least 3 mm.
double RobustSigma(std::vector<double> distances);

/// Estimates radii: for each capsule the median distance of its points to its axis, left and right together. Shrinks to
/// the previous radius when points are few. Uses frames [begin, end) of the state.
void CalibrateRadii(const std::vector<FusedCloud>& clouds, const PoseState& state, int begin, int end,
                    double max_distance, CapsuleBody& body);

}  // namespace mocurate
