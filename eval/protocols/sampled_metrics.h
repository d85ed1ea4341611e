#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/store/feature_file.h"
#include "eval/metrics/frechet_sampling.h"
#include "eval/metrics/interval.h"

namespace mocurate {

/// One metric of a row.
struct Figure {
  std::vector<double> values;              ///< of the repetitions; none: null
  std::optional<SampledInterval> sampled;  ///< by resampling motions or persons in theory, of the first repetition
  std::string why;                         ///< why there is no value, or no interval: a code
  nlohmann::json more = nlohmann::json::object();  ///< further keys
};
using Figures = std::map<std::string, Figure>;

/// {"value", "interval", "interval_kind", "repetitions", "sampled": {"interval", "kind"}, "why"} and the further keys.
/// `interval` is of the repetitions where there are several, else the sampled one.
nlohmann::json JsonOf(const Figure& figure, IntervalKind kind);

/// The rows of a set. `real`: motions of one person are one unit; else each motion is its own, because a network's
/// motions are independent given the network.
FeatureSample SampleOf(const FeatureSet& set, const std::vector<int>& rows, bool real);

/// Metrics of distinct motions against distinct real ones, beside those of the papers. `itself`: the row is the real
/// motions, and `row` and `reference` are two halves of `real`. [Chong and Forsyth 2020; Kynkaanniemi et al. 2019]
/// FID_equal ("motions", "real", "real_sd", "p", "draws"), FID_inf, FID_normalised, KID ("subsets"), density, coverage,
/// precision, recall, nearest_train, memorised.
Status AddSampledMetrics(const FeatureSample& row, const FeatureSample& reference, const FeatureSample& real,
                         bool itself, std::uint64_t seed, Figures& figures);

/// Adds the sampled interval of the FID of that name, about its first value. Returns the FIDs if the samples did not
/// differ; nothing for more than kLargestResampled features or a sample of one unit.
Expected<std::optional<NoDifference>> AddFidInterval(const std::string& name, const FeatureSample& row,
                                                     const FeatureSample& reference, std::uint64_t seed,
                                                     Figures& figures);

/// Adds APD and ACPD, and the sampled interval of the diversity, whose value is of `pairs` drawn pairs. Returns the
/// distances within labels; nothing where a label has fewer than two motions.
std::optional<PairDistances> AddPairDistances(const FeatureSample& sample, int pairs, Figures& figures);

/// Mean speed of the joints over that of real motions of the label, mean over the labels; nothing without a label or a
/// movement in common.
std::optional<double> MovementOfReal(const FeatureSet& set, const std::vector<int>& rows, const FeatureSet& real,
                                     const std::vector<int>& real_rows);

/// Above this number of features an exchange of motions takes seconds (D x D eigenvalues): neither p nor the interval
/// of FIDs is computed.
inline constexpr Eigen::Index kLargestResampled = 128;
inline constexpr int kExchanges = 199;  ///< smallest p 0.005

}  // namespace mocurate
