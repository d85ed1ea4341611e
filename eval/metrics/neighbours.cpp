#include "eval/metrics/neighbours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mocurate {
namespace {

constexpr Eigen::Index kRowsAtOnce = 512;

/// Squared distances of rows [begin, begin + n) of `a` to all rows of `b`.
Eigen::MatrixXd SquaredDistances(const Features& a, Eigen::Index begin, Eigen::Index n, const Features& b,
                                 const Eigen::VectorXd& b_norm) {
  const auto rows = a.middleRows(begin, n);
  Eigen::MatrixXd squared = -2.0 * rows * b.transpose();
  squared.colwise() += rows.rowwise().squaredNorm();
  squared.rowwise() += b_norm.transpose();
  return squared.cwiseMax(0.0);
}

/// Numerical error of a distance computed from squares, relative to the features' norm.
constexpr double kRounding = 1e-6;

}  // namespace

Expected<NeighbourFigures> CompareNeighbours(const Features& motions, const Features& reference, int k) {
  if (reference.rows() <= k || motions.rows() < 1 || motions.cols() != reference.cols()) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(motions.rows()) + " motions and a reference of " + std::to_string(reference.rows()),
                "density and coverage",
                "use a reference of more than " + std::to_string(k) + " motions, features of one extractor");
  }
  const Eigen::VectorXd norm = reference.rowwise().squaredNorm();
  Eigen::VectorXd radius(reference.rows());  // squared
  double own_nearest = 0.0;
  for (Eigen::Index begin = 0; begin < reference.rows(); begin += kRowsAtOnce) {
    const Eigen::Index n = std::min(kRowsAtOnce, reference.rows() - begin);
    Eigen::MatrixXd squared = SquaredDistances(reference, begin, n, reference, norm).transpose();  // a column each
    for (Eigen::Index i = 0; i < n; ++i) {
      squared(begin + i, i) = std::numeric_limits<double>::infinity();
      double* column = squared.col(i).data();
      std::nth_element(column, column + k - 1, column + reference.rows());
      radius(begin + i) = column[k - 1];
      own_nearest += std::sqrt(*std::min_element(column, column + k));
    }
  }
  std::vector<bool> covered(static_cast<std::size_t>(reference.rows()), false);
  long long inside = 0;
  double nearest = 0.0;
  for (Eigen::Index begin = 0; begin < motions.rows(); begin += kRowsAtOnce) {
    const Eigen::Index n = std::min(kRowsAtOnce, motions.rows() - begin);
    const Eigen::MatrixXd squared = SquaredDistances(motions, begin, n, reference, norm);
    for (Eigen::Index j = 0; j < reference.rows(); ++j) {
      for (Eigen::Index i = 0; i < n; ++i) {
        if (squared(i, j) > radius(j)) continue;
        ++inside;
        covered[static_cast<std::size_t>(j)] = true;
      }
    }
    nearest += squared.rowwise().minCoeff().cwiseSqrt().sum();
  }
  NeighbourFigures figures;
  figures.density = static_cast<double>(inside) / (static_cast<double>(k) * static_cast<double>(motions.rows()));
  figures.coverage =
      static_cast<double>(std::count(covered.begin(), covered.end(), true)) / static_cast<double>(reference.rows());
  const double among = own_nearest / static_cast<double>(reference.rows());
  // Repeated rows have distances at rounding level, which are no reference.
  const double rounding = kRounding * std::sqrt(norm.mean());
  figures.nearest = among > rounding ? nearest / static_cast<double>(motions.rows()) / among : 0.0;
  return figures;
}

}  // namespace mocurate
