#include "eval/metrics/fid.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace mocurate {

namespace {

Status CheckFeatures(Eigen::Index count, bool finite) {
  if (count < 2) {
    return Fail(ErrorCode::kInconsistent, std::to_string(count) + " motions; a covariance needs at least 2",
                "features");
  }
  if (finite) return {};
  return Fail(ErrorCode::kInconsistent, "a feature is not a finite number", "features",
              "check the motions for NaN or infinite positions, and whether the recogniser's training diverged");
}

}  // namespace

Expected<FeatureStatistics> StatisticsOf(const Features& features) {
  constexpr Eigen::Index kBlock = 4096;
  const Eigen::Index count = features.rows(), size = features.cols();
  if (Status sound = CheckFeatures(count, features.allFinite()); !sound) return Forward(sound);
  FeatureStatistics statistics;
  statistics.mean = features.colwise().mean();
  statistics.covariance = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index begin = 0; begin < count; begin += kBlock) {
    const Eigen::MatrixXd centred =
        features.middleRows(begin, std::min(kBlock, count - begin)).rowwise() - statistics.mean.transpose();
    statistics.covariance.selfadjointView<Eigen::Lower>().rankUpdate(centred.transpose());
  }
  statistics.covariance = statistics.covariance.selfadjointView<Eigen::Lower>();
  statistics.covariance /= static_cast<double>(count - 1);
  return statistics;
}

Expected<double> FrechetDistance(const FeatureStatistics& a, const FeatureStatistics& b) {
  if (a.mean.size() != b.mean.size()) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(a.mean.size()) + " and " + std::to_string(b.mean.size()) + " features per motion",
                "features", "compute both sets with the same recogniser");
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> first(a.covariance);
  const Eigen::VectorXd roots = first.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd root = first.eigenvectors() * roots.asDiagonal() * first.eigenvectors().transpose();
  const Eigen::MatrixXd product = root * b.covariance * root;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> second(0.5 * (product + product.transpose()),
                                                              Eigen::EigenvaluesOnly);
  const double trace_root = second.eigenvalues().cwiseMax(0.0).cwiseSqrt().sum();
  return (a.mean - b.mean).squaredNorm() + a.covariance.trace() + b.covariance.trace() - 2.0 * trace_root;
}

}  // namespace mocurate
