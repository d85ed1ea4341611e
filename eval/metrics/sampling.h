#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "eval/metrics/feature_distances.h"

namespace mocurate {

/// Features of motions, and which of them are independent of each other.
struct FeatureSample {
  Features features;       ///< (N,D)
  std::vector<int> label;  ///< (N), -1: none
  std::vector<int> unit;   ///< (N) in [0, units); motions of one unit are not independent
  int units = 0;
  bool persons = false;     ///< units are persons
  bool independent = true;  ///< false: the persons are not known, so no unit is known to be independent

  int count() const { return static_cast<int>(features.rows()); }
};

/// What an interval of a sample describes.
enum class SampledKind {
  kMotions,  ///< 95 %: other motions of the same kind
  kPersons,  ///< 95 %: motions of other persons
  kSpread,   ///< of these motions; for a 95 % interval fewer than kFewestUnits units, or persons that are not known
};
/// "motions_95", "persons_95", "spread".
const char* Name(SampledKind kind);

/// Fewest units with a 95 % interval, by (sum of motions)^2 / sum of squares where they have unequal numbers: below,
/// its own width is uncertain by more than a quarter (1 / sqrt(2 (P - 1))).
inline constexpr int kFewestUnits = 10;

struct SampledInterval {
  std::array<double, 2> ends{};
  SampledKind kind = SampledKind::kMotions;
};

/// The larger of two: a figure of two sets is as uncertain as its less certain side.
SampledKind KindOf(const FeatureSample& sample);
SampledKind KindOf(const FeatureSample& a, const FeatureSample& b);

/// Variance of the mean of one value a motion (its influence on a figure), values summed by unit: P / (P - 1) times the
/// sum of squares of the units' sums, over N^2. 0 for fewer than two units.
double VarianceOfMean(const Eigen::VectorXd& values, const FeatureSample& sample);

/// value -+ Student's quantile (`units` - 1 degrees of freedom) times the root of the variance, nothing for fewer than
/// two units or a variance that is not finite.
std::optional<SampledInterval> IntervalAbout(double value, double variance, int units, SampledKind kind);

/// Of a mean of the values, one a motion of the sample.
std::optional<SampledInterval> IntervalOfMean(const Eigen::VectorXd& values, const FeatureSample& sample);

/// Wilson's interval of a share of motions. `right`: 0 or 1 a motion. The number of motions is the effective one, p (1
/// - p) / VarianceOfMean, at most N. [Wilson 1927]
std::optional<SampledInterval> IntervalOfShare(const Eigen::VectorXd& right, const FeatureSample& sample);

/// Mean distance of all pairs of motions: of any two (APD), or of two of one label, each label with equal weight (ACPD,
/// average class pairwise distance). Diversity and multimodality are its estimates by drawn pairs.
struct PairDistances {
  double mean = 0.0;
  double variance = 0.0;  ///< of the U-statistic
  double square = 0.0;    ///< mean squared deviation of a pair's distance from its group's mean
  int units = 0;
  SampledKind kind = SampledKind::kMotions;

  /// The interval about a mean of `pairs` drawn pairs; 0: of all pairs.
  std::optional<SampledInterval> About(double value, int pairs) const;
};

/// Nothing where a group has fewer than two motions.
std::optional<PairDistances> DistancesOfAll(const FeatureSample& sample, bool within_labels);

}  // namespace mocurate
