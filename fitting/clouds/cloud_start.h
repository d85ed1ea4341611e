#pragma once

#include "fitting/clouds/capsule_fit.h"

namespace mocurate {

/// Lowest and highest point along y in metres, but for a few stray ones. Of a posed body: needs Update.
struct HeightSpan {
  double low = 0.0;
  double high = 0.0;

  double height() const { return high - low; }
};
HeightSpan HeightOf(const Eigen::Matrix3Xd& points);
HeightSpan HeightOf(const FleshBody& body, const PoseState& state, int frame);

/// Leaves in the state the pose of a frame that nothing is known about but that the person is near upright: fitted from
/// starts that face all around with arms in several places; the best few are fitted to all points, and the cheapest
/// stays. Errors of FitCloudFrame.
Status FindStart(const FleshBody& body, const FusedCloud& cloud, int frame, const PointCloudOptions& options,
                 PoseState& state);

}  // namespace mocurate
