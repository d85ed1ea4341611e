#pragma once

#include <Eigen/Core>

#include "core/base/error.h"

namespace mocurate {

/// Features of N motions, (N, D), row per motion.
using Features = Eigen::MatrixXd;

/// Mean and covariance (divisor N - 1) of features. [a2m_actor.md D.3]
struct FeatureStatistics {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// In blocks of rows: beside the features it needs (D, D) doubles. Error kInconsistent for fewer than two motions or a
/// number that is not finite.
Expected<FeatureStatistics> StatisticsOf(const Features& features);

/// Frechet distance |m1 - m2|^2 + tr S1 + tr S2 - 2 tr sqrt(S1^(1/2) S2 S1^(1/2)): the self-adjoint form, real whatever
/// the rank; negative rounding in eigenvalues counts as zero. Error kInconsistent if sizes differ.
Expected<double> FrechetDistance(const FeatureStatistics& a, const FeatureStatistics& b);

}  // namespace mocurate
