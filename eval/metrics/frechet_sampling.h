#pragma once

#include <optional>
#include <vector>

#include "core/base/random.h"
#include "eval/metrics/sampling.h"

/// What sampling does to Frechet distances (FID): its bias, its variance, and tests of differences. Everything needs
/// the numbers of `StatisticsOf`: two motions or more in each sample and finite features.
namespace mocurate {

/// FIDs at one number of motions, means over draws.
struct EqualSizeFid {
  int motions = 0;       ///< n of each set
  double row = 0.0;      ///< FID(G, B); of the real motions against themselves the same as `real`
  double real = 0.0;     ///< FID(A, B)
  double real_sd = 0.0;  ///< over the draws: how far one pair of halves is from another
  int draws = 0;
};

/// n = min(half of `real`, `row`). Each of `draws` draws takes two disjoint sets A and B of n real motions and G of n
/// motions of the row, without replacement; FID(A, B) and FID(G, B) have the same bias. The same seed and number of
/// real motions and n draw the same A and B for every row. `row` null: the real motions alone. Error kInconsistent
/// where n is below 2.
Expected<EqualSizeFid> FidAtEqualSizes(const Features* row, const Features& real, int draws, std::uint64_t seed);

/// FIDs of two samples if their motions of each label came from one distribution.
struct NoDifference {
  double p = 1.0;         ///< share of the draws, the observed one among them, whose FID is not less than the observed
  double variance = 0.0;  ///< of the draws' FIDs
};

/// `draws` times: where all units are motions, motions are exchanged between the samples within labels; else the
/// deviation of each unit from the mean and the second moments of its label gets a random sign. Samples with other
/// labels are compared as if all motions had one. [permutation test, and its form for units of several motions, the
/// wild bootstrap]
Expected<NoDifference> FidsOfNoDifference(const FeatureSample& a, const FeatureSample& b, int draws, Random& random);

/// Difference of two rows' FIDs against one reference.
struct FidDifference {
  int motions = 0;          ///< of each row: the smaller number
  double difference = 0.0;  ///< FID(a, reference) - FID(b, reference)
  double p = 1.0;           ///< share of `draws` exchanges within labels, with the observed one, that differ as much
};
Expected<FidDifference> DifferenceOfFids(const FeatureSample& a, const FeatureSample& b, const Features& reference,
                                         int draws, Random& random);

/// Variance of FID to first order: of the mean influence of each sample's motions, summed by unit. A motion x of the
/// first sample has 2 (m1 - m2)' (x - m1) + (x - m1)' (I - T) (x - m1) with T the optimal transport from S1 to S2 (T
/// S1 T = S2); the second sample likewise with its inverse. It vanishes where the distributions are equal, where
/// NoDifference::variance holds. [delta method; T: Gelbrich 1990]
Expected<double> FirstOrderVariance(const FeatureSample& a, const FeatureSample& b);

/// Fewest motions of each sample for an extrapolated FID, per feature: below, FID is not linear in 1 / n.
inline constexpr int kMotionsPerFeature = 10;

/// FID at infinitely many motions: linear in 1 / n through both samples at full size and without each of 20 parts of
/// whole units, so that each motion is left out once (the grouped jackknife). [Chong and Forsyth 2020 extrapolate from
/// random subsets; this has the smaller variance, docs/evaluation.md]. Nothing where a sample has fewer than
/// kMotionsPerFeature motions per feature, or where one unit has half of its motions. Fewer than 20 units have as many
/// parts.
Expected<std::optional<double>> ExtrapolatedFid(const FeatureSample& a, const FeatureSample& b, std::uint64_t seed);

/// Unbiased kernel distance of all motions (the U-statistic of KernelDistance), and its variance: of the influences,
/// summed by unit, and at least that of the pairs, which alone is left where the distributions are equal.
struct KernelEstimate {
  double value = 0.0;
  double variance = 0.0;
};
Expected<KernelEstimate> KernelDistanceOfAll(const FeatureSample& a, const FeatureSample& b);

/// Each row divided by its Euclidean length; a row of zeros stays.
Features Normalised(const Features& features);

}  // namespace mocurate
