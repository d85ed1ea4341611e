#include "core/geometry/rigid.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kSpreadRounding = 1e-13;  ///< spread of points relative to their distance from the origin
constexpr double kCollinear = 1e-12;       ///< second to first singular value

/// Whether points deviate from their centroid by nothing but rounding.
bool IsSinglePoint(const Eigen::Matrix3Xd& deviation, const Vector3d& centroid, const Eigen::VectorXd& weights) {
  double spread = 0.0;
  for (Eigen::Index i = 0; i < deviation.cols(); ++i) {
    if (weights[i] > 0.0) spread = std::max(spread, deviation.col(i).stableNorm());
  }
  return spread <= kSpreadRounding * centroid.stableNorm();
}

/// Rotation R that maximises trace(R * covariance), covariance = sum of w s t^T.
Quaterniond BestRotation(const Matrix3d& covariance) {
  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& singular = svd.singularValues();
  if (singular[0] <= 0.0) return Quaterniond::Identity();
  if (singular[1] <= kCollinear * singular[0]) return SwingBetween(svd.matrixU().col(0), svd.matrixV().col(0));
  Vector3d signs = Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  const Matrix3d rotation = svd.matrixV() * signs.asDiagonal() * svd.matrixU().transpose();
  return Quaterniond(rotation).normalized();
}

}  // namespace

RigidTransform operator*(const RigidTransform& c_from_b, const RigidTransform& b_from_a) {
  return {(c_from_b.rotation * b_from_a.rotation).normalized(), c_from_b * b_from_a.translation};
}

RigidTransform Inverse(const RigidTransform& b_from_a) {
  const Quaterniond a_from_b = b_from_a.rotation.conjugate();
  return {a_from_b, -(a_from_b * b_from_a.translation)};
}

RigidTransform AlignPoints(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target,
                           const Eigen::VectorXd& weights) {
  const double total = weights.sum();
  const Vector3d source_centre = source * weights / total;
  const Vector3d target_centre = target * weights / total;
  const Eigen::Matrix3Xd from = source.colwise() - source_centre;
  const Eigen::Matrix3Xd to = target.colwise() - target_centre;

  RigidTransform target_from_source;
  if (!IsSinglePoint(from, source_centre, weights) && !IsSinglePoint(to, target_centre, weights)) {
    target_from_source.rotation = BestRotation(from * weights.asDiagonal() * to.transpose());
  }
  target_from_source.translation = target_centre - target_from_source.rotation * source_centre;
  return target_from_source;
}

}  // namespace mocurate
