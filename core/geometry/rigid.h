#pragma once

#include "core/geometry/rotation.h"

namespace mocurate {

/// Rigid transform target_from_source: y = rotation * x + translation. Metres.
struct RigidTransform {
  Quaterniond rotation = Quaterniond::Identity();
  Vector3d translation = Vector3d::Zero();

  Vector3d operator*(const Vector3d& point_in_source) const { return rotation * point_in_source + translation; }
};

/// c_from_a = c_from_b * b_from_a.
RigidTransform operator*(const RigidTransform& c_from_b, const RigidTransform& b_from_a);
RigidTransform Inverse(const RigidTransform& b_from_a);

/// Least-squares rigid transform target_from_source between paired points with weights (Kabsch/Umeyama, no scale,
/// determinant +1). Points are columns. With fewer than three non-collinear pairs the rotation about the free axis is
/// the smallest one. Weights must not be negative; at least one must be positive.
RigidTransform AlignPoints(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target,
                           const Eigen::VectorXd& weights);

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
