#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/job_options.h"
#include "core/pipeline/runner.h"

namespace mocurate {

/// How much shorter a job trains so that it keeps to a time.
struct TimeBudget {
  double factor = 1.0;                 ///< of the iterations of generators
  std::int64_t recogniser_epochs = 0;  ///< of recognisers at most; 0: as the job says
};

/// Makes the datasets elsewhere, measures a few steps of each network, and shares `seconds` out: recognisers have at
/// most half of the training, generators the rest, each for the same part of its iterations; one step at least. What
/// was found is kept as time_budget.json in `folder` and taken from there when the same run goes on. Error kUsage where
/// not one step of each network fits; those of the stages.
Expected<TimeBudget> MakeTimeBudget(double seconds, const JobOptions& options, const RunnerOptions& settings,
                                    const std::filesystem::path& folder);

}  // namespace mocurate
