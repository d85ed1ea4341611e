#pragma once

#include "core/geometry/rigid.h"

namespace mocurate {

/// A rigid transform of paired points with outliers, and its inliers. Metres.
struct RobustAlignment {
  RigidTransform target_from_source;
  double median = 0.0;  ///< of the distances that remain, over all pairs that weigh
  double share = 0.0;   ///< weight of the pairs within three times that, of all
  double spread = 0.0;  ///< second singular value of the source points about their middle, per point: 0 is a line
};

/// Iteratively reweighted Procrustes (Geman and McClure's weights about the median distance, never below `floor`
/// metres), from plain least squares: reliable with less than about 40 % outliers. Points are columns; weights
/// must not be negative, at least one must be positive.
RobustAlignment AlignPointsRobustly(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target,
                                    const Eigen::VectorXd& weights, double floor = 0.01);

}  // namespace mocurate
