#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/random.h"

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

/// Kernel distance (KID): the unbiased estimate of the squared maximum mean discrepancy with the kernel (x.y / D +
/// 1)^3, of `count` random subsets of `size` motions of each set. [Binkowski et al. 2018, section 4]
struct KernelSubsets {
  double mean = 0.0;
  double sd = 0.0;  ///< over the subsets; 0 for one
  int count = 0;
  int size = 0;
};

/// `subsets` of at most `size` motions; one of all where both sets have no more. Unlike FID the mean is unbiased for
/// few motions. Error kInconsistent for fewer than two motions in a set.
Expected<KernelSubsets> KernelDistance(const Features& a, const Features& b, int subsets, int size, Random& random);

/// Pairs of motions for a metric's distances; drawn separately from the metric, so that a reference's draws can be
/// replayed.
using IndexPairs = std::vector<std::pair<int, int>>;

/// Diversity's pairs: both ends uniform with replacement, i = j possible. [a2m_actor.md D.5]
IndexPairs DrawDiversityPairs(int motions, int pairs, Random& random);

/// Multimodality's pairs: `quota` for each class that has motions, both ends uniform within the class, with
/// replacement. A class without motions has no pairs. Motions without a class (-1) are ignored.
IndexPairs DrawMultimodalityPairs(const std::vector<int>& labels, int classes, int quota, Random& random);

/// Mean Euclidean distance over the pairs; 0 without pairs.
double MeanDistance(const Features& features, const IndexPairs& pairs);

/// Motions of a block of distances.
inline constexpr Eigen::Index kRowsAtOnce = 128;

/// Squared distances of all rows of `b` to rows [begin, begin + n) of `a`: (rows of b, n), a column a motion of `a`,
/// into a matrix that is reused from block to block. `b_norm`: squared lengths of the rows of `b`.
void SquaredDistances(const Features& a, Eigen::Index begin, Eigen::Index n, const Features& b,
                      const Eigen::VectorXd& b_norm, Eigen::MatrixXd& squared);

/// Nearest-neighbour metrics of features.
struct NeighbourFigures {
  /// Mean over the motions of the number of reference balls that contain them, divided by k: about 1 for motions like
  /// the reference.
  double density = 0.0;
  double coverage = 0.0;   ///< share of the reference's balls that contain a motion
  double precision = 0.0;  ///< share of the motions in any of the reference's balls
  double recall = 0.0;     ///< share of the reference in any of the motions' balls; 0 for k motions or fewer
  /// Mean distance of the motions to their nearest in the reference, divided by that of the reference's motions to
  /// their nearest other: about 1 for new motions, near 0 for copies of the reference.
  double nearest = 0.0;
  /// Mean distance of the motions to their nearest other, divided by that of the reference: near 0 for equal motions.
  double own_nearest = 0.0;
  double memorised = 0.0;  ///< share of the motions nearer to one of the reference than kMemorised of that mean
};

/// Copies of the same window differ by rounding: a hundredth of the mean distance between neighbours.
inline constexpr double kMemorised = 0.01;

/// A ball reaches from a motion to its k-th nearest other of its set. [density and coverage: Naeem et al. 2020,
/// equations 3 and 4, k = 5; precision and recall: Kynkaanniemi et al. 2019, with the same k] Error kInconsistent where
/// the reference has no k others or features differ in number.
Expected<NeighbourFigures> CompareNeighbours(const Features& motions, const Features& reference, int k = 5);

}  // namespace mocurate
