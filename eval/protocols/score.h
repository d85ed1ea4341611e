#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/store/feature_file.h"
#include "eval/metrics/feature_distances.h"
#include "eval/options.h"

namespace mocurate {

/// Features of one repetition, with their rows in the set.
struct ScoredRows {
  std::vector<int> rows;
  Features features;        ///< (rows, D)
  std::vector<int> labels;  ///< -1: no class
};

/// The motions of a repetition: the set's pass of that repetition where it has one each, else a draw of `draw.motions`
/// (0: all). Same seed, purpose and repetition, same draw.
ScoredRows RowsOfRepetition(const FeatureSet& set, const DrawOptions& draw, std::uint64_t seed, int repetition,
                            const std::string& purpose);

/// References of a row.
struct References {
  const FeatureSet* train = nullptr;
  const FeatureSet* test = nullptr;
};

/// All metrics of one row: {"name", "motions", "metrics": {NAME: {"value", "interval": [low, high] or null,
/// "interval_kind", "repetitions": [...],
/// "bootstrap_95": of the first repetition's motions}}, "assumed": [codes], "confusion": (C,C), "warnings": [{"code",
/// "message"}]}. A metric that cannot be computed has the value null: FID and its like without a reference,
/// multimodality where a class has no motions, accuracy without labels. Errors: features of another dimension; a number
/// that is not finite.
Expected<nlohmann::json> ScoreRow(const ScoreOptions& options, const FeatureSet& row, const References& references);

/// Compares two rows: {"a", "b", "metrics": {NAME: {"difference", "p"}}}, by exchanging motions of equal index between
/// the rows (nothing drawn) or signs of the repetitions' differences. p is null where repetitions score the same
/// motions, because these are not independent samples.
Expected<nlohmann::json> CompareRows(const ScoreOptions& options, const FeatureSet& a, const FeatureSet& b,
                                     const FeatureSet& reference);

}  // namespace mocurate
