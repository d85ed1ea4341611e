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

/// All metrics of one row: {"name", "motions", "metrics": {NAME: as of JsonOf(Figure)}, "assumed": [codes],
/// "confusion": (C,C), "warnings": [{"code", "message"}]}. A metric that cannot be computed has the value null and
/// "why": FID and its like without a reference or with too few motions, multimodality where a class has no motions or
/// every class one, accuracy without labels. Errors: features of another dimension; a number that is not finite.
Expected<nlohmann::json> ScoreRow(const ScoreOptions& options, const FeatureSet& row, const References& references);

/// Compares the motions of two rows, and so these checkpoints, not the methods that trained them: {"FID_train":
/// {"difference", "p", "motions": of each row}} by DifferenceOfFids; empty for more than kLargestResampled features.
Expected<nlohmann::json> CompareRows(const ScoreOptions& options, const FeatureSet& a, const FeatureSet& b,
                                     const FeatureSet& reference);

}  // namespace mocurate
