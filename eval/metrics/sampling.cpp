#include "eval/metrics/sampling.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "eval/metrics/interval.h"

namespace mocurate {
namespace {

Eigen::VectorXd SumsByUnit(const Eigen::VectorXd& values, const FeatureSample& sample) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(sample.units);
  for (Eigen::Index i = 0; i < values.size(); ++i) sums(sample.unit[static_cast<std::size_t>(i)]) += values(i);
  return sums;
}

/// Mean distances of motions to the others of a group.
struct GroupDistances {
  Eigen::VectorXd influence;  ///< (members) of each on the mean distance of the group, centred
  double mean = 0.0;
  double square = 0.0;  ///< mean squared deviation of a pair's distance
};

GroupDistances DistancesWithin(const FeatureSample& sample, const std::vector<int>& members) {
  const auto n = static_cast<Eigen::Index>(members.size());
  const Features features = sample.features(members, Eigen::all);
  const Eigen::VectorXd norm = features.rowwise().squaredNorm();
  Eigen::VectorXd sums(n);
  Eigen::MatrixXd squared;
  double squares = 0.0;
  for (Eigen::Index begin = 0; begin < n; begin += kRowsAtOnce) {
    const Eigen::Index rows = std::min(kRowsAtOnce, n - begin);
    SquaredDistances(features, begin, rows, features, norm, squared);
    sums.segment(begin, rows) = squared.cwiseSqrt().colwise().sum();
    squares += squared.sum();
  }
  const double pairs = static_cast<double>(n) * static_cast<double>(n - 1);
  const double mean = sums.sum() / pairs;
  GroupDistances distances;
  distances.mean = mean;
  distances.influence = 2.0 * (sums.array() / static_cast<double>(n - 1) - mean);
  distances.square = std::max(0.0, squares / pairs - mean * mean);
  return distances;
}

}  // namespace

const char* Name(SampledKind kind) {
  return kind == SampledKind::kMotions ? "motions_95" : kind == SampledKind::kPersons ? "persons_95" : "spread";
}

SampledKind KindOf(const FeatureSample& sample) {
  Eigen::VectorXd motions = Eigen::VectorXd::Zero(sample.units);
  for (const int unit : sample.unit) motions(unit) += 1.0;
  const double effective = motions.sum() * motions.sum() / std::max(1.0, motions.squaredNorm());
  if (!sample.independent || effective < kFewestUnits) return SampledKind::kSpread;
  return sample.persons ? SampledKind::kPersons : SampledKind::kMotions;
}

SampledKind KindOf(const FeatureSample& a, const FeatureSample& b) { return std::max(KindOf(a), KindOf(b)); }

double VarianceOfMean(const Eigen::VectorXd& values, const FeatureSample& sample) {
  if (sample.units < 2 || values.size() == 0) return 0.0;
  const double n = static_cast<double>(values.size()), units = sample.units;
  const Eigen::VectorXd centred = values.array() - values.mean();
  return units / (units - 1.0) * SumsByUnit(centred, sample).squaredNorm() / (n * n);
}

std::optional<SampledInterval> IntervalAbout(double value, double variance, int units, SampledKind kind) {
  if (units < 2 || !std::isfinite(variance)) return std::nullopt;
  const double half = StudentQuantile(0.975, units - 1) * std::sqrt(std::max(0.0, variance));
  return SampledInterval{{value - half, value + half}, kind};
}

std::optional<SampledInterval> IntervalOfMean(const Eigen::VectorXd& values, const FeatureSample& sample) {
  if (values.size() == 0) return std::nullopt;
  auto interval = IntervalAbout(values.mean(), VarianceOfMean(values, sample), sample.units, KindOf(sample));
  if (interval && values.minCoeff() >= 0.0) interval->ends[0] = std::max(0.0, interval->ends[0]);
  return interval;
}

std::optional<SampledInterval> IntervalOfShare(const Eigen::VectorXd& right, const FeatureSample& sample) {
  if (right.size() == 0 || sample.units < 2) return std::nullopt;
  const double share = right.mean(), own = share * (1.0 - share);
  const double variance = VarianceOfMean(right, sample);
  // Where all units are as right nothing is known of their dependence: as many as there are units.
  double count = variance > 1e-12 * own ? own / variance : static_cast<double>(sample.units);
  count = std::clamp(count, 1.0, static_cast<double>(right.size()));
  const double z = StudentQuantile(0.975, sample.units - 1), square = z * z;
  const double middle = (share + square / (2.0 * count)) / (1.0 + square / count);
  const double half = z / (1.0 + square / count) * std::sqrt(own / count + square / (4.0 * count * count));
  return SampledInterval{{std::max(0.0, middle - half), std::min(1.0, middle + half)}, KindOf(sample)};
}

std::optional<SampledInterval> PairDistances::About(double value, int pairs) const {
  return IntervalAbout(value, variance + (pairs > 0 ? square / pairs : 0.0), units, kind);
}

std::optional<PairDistances> DistancesOfAll(const FeatureSample& sample, bool within_labels) {
  std::map<int, std::vector<int>> groups;
  for (int i = 0; i < sample.count(); ++i) {
    const int label = within_labels ? sample.label[static_cast<std::size_t>(i)] : 0;
    if (label >= 0) groups[label].push_back(i);
  }
  if (groups.empty()) return std::nullopt;
  Eigen::VectorXd influence = Eigen::VectorXd::Zero(sample.count());
  PairDistances all;
  const double share = 1.0 / static_cast<double>(groups.size());
  for (const auto& [label, members] : groups) {
    if (members.size() < 2) return std::nullopt;
    const GroupDistances distances = DistancesWithin(sample, members);
    // VarianceOfMean divides by the number of all motions: a group's mean is over its own.
    const double weight = share * sample.count() / static_cast<double>(members.size());
    influence(members) = weight * distances.influence;
    all.mean += share * distances.mean;
    all.square += share * distances.square;
  }
  all.variance = VarianceOfMean(influence, sample);
  all.units = sample.units;
  all.kind = KindOf(sample);
  return all;
}

}  // namespace mocurate
