#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "job/job_items.h"
#include "job/stage_runs.h"
#include "job/training_run.h"

namespace mocurate {

/// Test sets of recognisers: test clips of the dataset, the same before fitting, the same encoded and decoded.
struct TestSets {
  const ItemResult& dataset;
  const ItemResult& unfitted;
  const std::vector<DenoisedSet>& denoised;
};

/// Accuracy and confusion of every recogniser on the test clips, by its name, and on denoised ones. Denoised clips are
/// those of the network whose motions it was trained on, else of the first network trained on the same part of the same
/// split: {"test_accuracy" (by seed), "mean", "denoised_accuracy" (by seed, with such clips), "test_clips", "labels",
/// "confusion", "scored"}.
Expected<nlohmann::json> ScoreRecognisers(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                                          const TestSets& sets, StageRuns& runs);

/// These accuracies as a result of ResultTable, a row per recogniser in the order of the options: metrics "accuracy"
/// and "accuracy_denoised".
nlohmann::json RecognitionRows(const TrainOptions& options, const nlohmann::json& recognisers,
                               const nlohmann::json& published);

/// Published numbers without those of recognisers, which have their own table.
nlohmann::json WithoutRecognisers(const nlohmann::json& published);

/// Published numbers below a table of the options.
Expected<nlohmann::json> PublishedOfTable(const EvaluateOptions& evaluate);

struct GeneratorScores {
  nlohmann::json metrics;  ///< {"protocol", "variant", "extractor", "rows", "comparisons", "warnings"}; lists may be
                           ///< empty
  std::optional<Error> unevaluated;  ///< why rows are missing
};

/// Scores real motions and those of every generator with the features of the run's recogniser; nothing without a
/// recogniser, or where the options exclude generators.
Expected<GeneratorScores> ScoreGenerators(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                                          const ItemResult& dataset, StageRuns& runs);

/// Adds to each row of a network `ours`: {"metrics", "checkpoint": sha256, "steps", "parameters", "seconds",
/// "peak_memory", "unconverged"}. Null: unknown, such as the seconds of a network from another run's cache.
/// `summaries`: of the stage `train`, by item; `journal`: entries of the run's journal, by item. `unconverged` is the
/// reason why a network is not converged: a limit or budget ended it, or its FID changed by more than the share
/// evaluate.settled since its last sample. Such a row has the same text under its own key `unconverged`.
void AddTraining(const std::vector<TrainedNetwork>& networks, const JobOptions& options,
                 const nlohmann::json& summaries, const std::map<std::string, nlohmann::json>& journal,
                 nlohmann::json& rows);

}  // namespace mocurate
