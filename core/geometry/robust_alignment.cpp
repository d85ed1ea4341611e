#include "core/geometry/robust_alignment.h"
#include "core/base/median.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace mocurate {
namespace {

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
