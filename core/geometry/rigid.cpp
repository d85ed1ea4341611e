#include "core/geometry/rigid.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/median.h"

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

constexpr int kIterations = 30;
constexpr double kSettled = 1e-7;  // metres and radians

std::vector<double> Distances(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target,
                              const RigidTransform& target_from_source) {
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < source.cols(); ++i) {
    distances.push_back((target_from_source * Vector3d(source.col(i)) - target.col(i)).norm());
  }
  return distances;
}

double MedianWhereWeighed(const std::vector<double>& distances, const Eigen::VectorXd& weights) {
  std::vector<double> weighed;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (weights[static_cast<Eigen::Index>(i)] > 0.0) weighed.push_back(distances[i]);
  }
  return Median(std::move(weighed));
}

double SpreadOf(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& weights) {
  const double total = weights.sum();
  const Eigen::Matrix3Xd from = points.colwise() - Vector3d(points * weights / total);
  const Matrix3d covariance = from * weights.asDiagonal() * from.transpose() / total;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
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

RobustAlignment AlignPointsRobustly(const Eigen::Matrix3Xd& source, const Eigen::Matrix3Xd& target,
                                    const Eigen::VectorXd& weights, double floor) {
  RobustAlignment alignment;
  alignment.spread = SpreadOf(source, weights);
  alignment.target_from_source = AlignPoints(source, target, weights);
  std::vector<double> distances = Distances(source, target, alignment.target_from_source);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    // A median of |r| of three Gaussian axes is 1.54 sigma.
    const double scale = 2.0 * std::max(floor, MedianWhereWeighed(distances, weights) / 1.54);
    Eigen::VectorXd robust = weights;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const double ratio = distances[i] / scale;
      robust[static_cast<Eigen::Index>(i)] /= (1.0 + ratio * ratio) * (1.0 + ratio * ratio);
    }
    const RigidTransform next = AlignPoints(source, target, robust);
    const double moved = (next.translation - alignment.target_from_source.translation).norm() +
                         AngleBetween(next.rotation, alignment.target_from_source.rotation);
    alignment.target_from_source = next;
    distances = Distances(source, target, next);
    if (moved < kSettled) break;
  }
  alignment.median = MedianWhereWeighed(distances, weights);
  const double limit = 3.0 * std::max(floor, alignment.median);
  double inside = 0.0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] <= limit) inside += weights[static_cast<Eigen::Index>(i)];
  }
  alignment.share = inside / weights.sum();
  return alignment;
}

}  // namespace mocurate
