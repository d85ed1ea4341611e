#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/job_items.h"
#include "app/stage_runs.h"
#include "app/training_run.h"

namespace mocurate {

/// What recognisers are scored on: test clips of the dataset, the same before fitting, the same encoded and decoded.
struct TestSets {
  const ItemResult& dataset;
  const ItemResult& unfitted;
  const std::vector<DenoisedSet>& denoised;
};

/// Accuracy and confusion of every recogniser on the test clips, by its name, and on those that a network denoised: the
/// one that made what it is trained on, else the first that learned from the same part of the same split:
/// {"test_accuracy" (by seed), "mean", "denoised_accuracy" (by seed, where there are such clips), "test_clips",
/// "labels", "confusion", "scored"}.
Expected<nlohmann::json> ScoreRecognisers(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                                          const TestSets& sets, StageRuns& runs);

/// These accuracies as a result of ResultTable, a row per recogniser in the order of the options: metrics "accuracy"
/// and "accuracy_denoised".
nlohmann::json RecognitionRows(const TrainOptions& options, const nlohmann::json& recognisers,
                               const nlohmann::json& published);

/// Published numbers but those of recognisers, which have a table of their own.
nlohmann::json WithoutRecognisers(const nlohmann::json& published);

/// Published numbers that stand below a table of the options.
Expected<nlohmann::json> PublishedOfTable(const EvaluateOptions& evaluate);

struct GeneratorScores {
  nlohmann::json metrics;  ///< {"protocol", "variant", "extractor", "rows", "comparisons", "warnings"}; lists may be
                           ///< empty
  std::optional<Error> unevaluated;  ///< why rows are missing
};

/// Real motions and those of every generator, by the features of the run's recogniser; nothing where it has none, or
/// the options leave generators out.
Expected<GeneratorScores> ScoreGenerators(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                                          const ItemResult& dataset, StageRuns& runs);

}  // namespace mocurate
