#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "job/config_loading.h"
#include "job/main_job.h"

namespace mocurate {

/// A run over several sets: for each of `data` its job runs through all stages in RUN/data/NAME, with the networks and
/// the evaluation of the run.
struct SetResult {
  DataSetOptions set;
  bool substitute = false;  ///< written by the studio instead of the set
  JobResult result;
};

struct DataSetsRun {
  std::vector<SetResult> sets;
  std::vector<std::pair<std::string, Error>> failed;  ///< sets that ended with an error
  nlohmann::json table;  ///< {"rows": [{"method", "dataset", "ours"}], "published", "notes"}
};

/// Runs all sets with training times scaled by `budget`, each with its own runner over `settings`, and writes tables
/// and metrics.json into the run folder. A set that fails does not stop the others. Errors: kInterrupted, kCannotWrite,
/// those of loading a job.
Expected<DataSetsRun> RunOverSets(const JobOptions& options, JobStage last, double budget,
                                  const RunnerOptions& settings);

}  // namespace mocurate
