#include "eval/metrics/feature_distances.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

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

/// `size` different rows, drawn by the first steps of a Fisher-Yates shuffle.
Features DrawRows(const Features& features, Eigen::Index size, Random& random) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(features.rows()));
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  Features drawn(size, features.cols());
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto left = static_cast<std::uint64_t>(features.rows() - i);
    std::swap(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(i) + random.Below(left)]);
    drawn.row(i) = features.row(rows[static_cast<std::size_t>(i)]);
  }
  return drawn;
}

/// (x.y / D + 1)^3 of all pairs.
Eigen::ArrayXXd Kernel(const Features& a, const Features& b) {
  return ((a * b.transpose()).array() / static_cast<double>(a.cols()) + 1.0).cube();
}

/// Numerical error of a distance computed from squares, relative to the features' norm.
constexpr double kRounding = 1e-6;

/// Balls around the motions of a set.
struct Balls {
  Eigen::VectorXd radius;  ///< (N) squared
  double nearest = 0.0;    ///< mean distance to the nearest other
};

Balls BallsOf(const Features& set, const Eigen::VectorXd& norm, int k) {
  Balls balls;
  balls.radius.resize(set.rows());
  Eigen::MatrixXd squared;
  for (Eigen::Index begin = 0; begin < set.rows(); begin += kRowsAtOnce) {
    const Eigen::Index n = std::min(kRowsAtOnce, set.rows() - begin);
    SquaredDistances(set, begin, n, set, norm, squared);
    for (Eigen::Index i = 0; i < n; ++i) {
      squared(begin + i, i) = std::numeric_limits<double>::infinity();
      double* column = squared.col(i).data();
      std::nth_element(column, column + k - 1, column + set.rows());
      balls.radius(begin + i) = column[k - 1];
      balls.nearest += std::sqrt(*std::min_element(column, column + k)) / static_cast<double>(set.rows());
    }
  }
  return balls;
}

double Share(const std::vector<bool>& flags) {
  return static_cast<double>(std::count(flags.begin(), flags.end(), true)) / static_cast<double>(flags.size());
}

}  // namespace

void SquaredDistances(const Features& a, Eigen::Index begin, Eigen::Index n, const Features& b,
                      const Eigen::VectorXd& b_norm, Eigen::MatrixXd& squared) {
  const auto rows = a.middleRows(begin, n);
  squared.resize(b.rows(), n);
  squared.noalias() = -2.0 * b * rows.transpose();
  for (Eigen::Index i = 0; i < n; ++i) {
    squared.col(i) = (squared.col(i).array() + b_norm.array() + rows.row(i).squaredNorm()).max(0.0);
  }
}

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

Expected<KernelSubsets> KernelDistance(const Features& a, const Features& b, int subsets, int size, Random& random) {
  const Eigen::Index n = std::min({static_cast<Eigen::Index>(size), a.rows(), b.rows()});
  if (n < 2 || a.cols() != b.cols()) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(a.rows()) + " and " + std::to_string(b.rows()) + " motions of " +
                    std::to_string(a.cols()) + " and " + std::to_string(b.cols()) + " features",
                "KID", "use two motions or more in each set, of one extractor");
  }
  const bool whole = n == a.rows() && n == b.rows();
  std::vector<double> values;
  for (int s = 0; s < (whole ? 1 : subsets); ++s) {
    const Features x = whole ? a : DrawRows(a, n, random), y = whole ? b : DrawRows(b, n, random);
    const Eigen::ArrayXXd xx = Kernel(x, x), yy = Kernel(y, y);
    const double own = xx.sum() - xx.matrix().trace() + yy.sum() - yy.matrix().trace();
    values.push_back(own / static_cast<double>(n * (n - 1)) - 2.0 * Kernel(x, y).mean());
  }
  KernelSubsets of{0.0, 0.0, static_cast<int>(values.size()), static_cast<int>(n)};
  for (const double value : values) of.mean += value / of.count;
  for (const double value : values) of.sd += (value - of.mean) * (value - of.mean) / std::max(1, of.count - 1);
  of.sd = std::sqrt(of.sd);
  return of;
}

IndexPairs DrawDiversityPairs(int motions, int pairs, Random& random) {
  IndexPairs drawn;
  drawn.reserve(pairs);
  for (int i = 0; i < pairs; ++i) {
    const int first = static_cast<int>(random.Below(motions));
    const int second = static_cast<int>(random.Below(motions));
    drawn.emplace_back(first, second);
  }
  return drawn;
}

IndexPairs DrawMultimodalityPairs(const std::vector<int>& labels, int classes, int quota, Random& random) {
  std::vector<std::vector<int>> members(static_cast<std::size_t>(classes));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] >= 0 && labels[i] < classes)
      members[static_cast<std::size_t>(labels[i])].push_back(static_cast<int>(i));
  }
  IndexPairs drawn;
  for (const std::vector<int>& of_class : members) {
    for (int i = 0; !of_class.empty() && i < quota; ++i) {
      const int first = of_class[random.Below(of_class.size())];
      const int second = of_class[random.Below(of_class.size())];
      drawn.emplace_back(first, second);
    }
  }
  return drawn;
}

double MeanDistance(const Features& features, const IndexPairs& pairs) {
  if (pairs.empty()) return 0.0;
  double sum = 0.0;
  for (const auto& [first, second] : pairs) sum += (features.row(first) - features.row(second)).norm();
  return sum / static_cast<double>(pairs.size());
}

Expected<NeighbourFigures> CompareNeighbours(const Features& motions, const Features& reference, int k) {
  if (reference.rows() <= k || motions.rows() < 1 || motions.cols() != reference.cols()) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(motions.rows()) + " motions and a reference of " + std::to_string(reference.rows()),
                "density and coverage",
                "use a reference of more than " + std::to_string(k) + " motions, features of one extractor");
  }
  const Eigen::VectorXd norm = reference.rowwise().squaredNorm(), own_norm = motions.rowwise().squaredNorm();
  const Balls balls = BallsOf(reference, norm, k);
  const bool recalled_too = motions.rows() > k;
  const Balls own_balls = recalled_too ? BallsOf(motions, own_norm, k) : Balls();
  const Eigen::VectorXd& own_radius = own_balls.radius;
  // Repeated rows have distances at rounding level, which are no reference.
  const bool among = balls.nearest > kRounding * std::sqrt(norm.mean());
  const double copy = std::pow(std::max(kMemorised * balls.nearest, kRounding * std::sqrt(norm.mean())), 2);
  std::vector<bool> covered(static_cast<std::size_t>(reference.rows()), false), recalled = covered;
  std::vector<bool> inside(static_cast<std::size_t>(motions.rows()), false);
  long long memberships = 0, copies = 0;
  double nearest = 0.0;
  Eigen::MatrixXd squared;
  for (Eigen::Index begin = 0; begin < motions.rows(); begin += kRowsAtOnce) {
    const Eigen::Index n = std::min(kRowsAtOnce, motions.rows() - begin);
    SquaredDistances(motions, begin, n, reference, norm, squared);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double own = recalled_too ? own_radius(begin + i) : -1.0;
      for (Eigen::Index j = 0; j < reference.rows(); ++j) {
        if (squared(j, i) <= own) recalled[static_cast<std::size_t>(j)] = true;
        if (squared(j, i) > balls.radius(j)) continue;
        ++memberships;
        covered[static_cast<std::size_t>(j)] = true;
        inside[static_cast<std::size_t>(begin + i)] = true;
      }
      const double least = squared.col(i).minCoeff();
      nearest += std::sqrt(least);
      copies += least <= copy ? 1 : 0;
    }
  }
  const double count = static_cast<double>(motions.rows());
  NeighbourFigures figures;
  figures.density = static_cast<double>(memberships) / (static_cast<double>(k) * count);
  figures.coverage = Share(covered);
  figures.precision = Share(inside);
  figures.recall = Share(recalled);
  figures.nearest = among ? nearest / count / balls.nearest : 0.0;
  figures.own_nearest = among && recalled_too ? own_balls.nearest / balls.nearest : 1.0;
  figures.memorised = static_cast<double>(copies) / count;
  return figures;
}

}  // namespace mocurate
