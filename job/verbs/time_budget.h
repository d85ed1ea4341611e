#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "job/job_options.h"

namespace mocurate {

/// Reduction of a job's training to a time budget.
struct TimeBudget {
  double factor = 1.0;                 ///< of the iterations of generators
  std::int64_t recogniser_epochs = 0;  ///< of recognisers at most; 0: as the job says
};

/// Makes the datasets in a temporary folder, measures a few steps of each network, and distributes `seconds`:
/// recognisers get at most half of the training time, generators the rest, each for the same share of its iterations,
/// at least one step. The result is saved as time_budget.json in `folder` and read when the same run continues. Error
/// kUsage where one step of each network does not fit; those of the stages.
Expected<TimeBudget> MakeTimeBudget(double seconds, const JobOptions& options, const RunnerOptions& settings,
                                    const std::filesystem::path& folder);

}  // namespace mocurate
