#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/config_loading.h"
#include "app/main_job.h"

namespace mocurate {

/// A run over several sets: for each of `data` the job that it names goes through all stages in RUN/data/NAME, with the
/// networks and the evaluation of the run.
struct SetResult {
  DataSetOptions set;
  bool substitute = false;  ///< written by the studio in the place of the set
  JobResult result;
};

struct DataSetsRun {
  std::vector<SetResult> sets;
  std::vector<std::pair<std::string, Error>> failed;  ///< sets that ended with an error
  nlohmann::json table;  ///< {"rows": [{"method", "dataset", "ours"}], "published", "notes"}
};

/// Runs all sets, their trainings times `budget`, each with a runner of its own over `settings`, and writes tables and
/// metrics.json into the run folder. A set that fails costs itself. Errors: kInterrupted, kCannotWrite, those of
/// loading a job.
Expected<DataSetsRun> RunOverSets(const JobOptions& options, JobStage last, double budget,
                                  const RunnerOptions& settings);

}  // namespace mocurate
