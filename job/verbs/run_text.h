#pragma once

#include "job/main_job.h"

namespace mocurate {

/// Number of items that the run has processed, or that a dry run would process.
int Executed(const JobResult& result);

/// Prints counts of clips, figures and paths of outputs to stdout; the log has the stages.
void PrintResult(const JobResult& result, double seconds);

/// Prints for each stage to stdout how many items would run and how many are in the cache.
void PrintPlan(const JobResult& result, JobStage last);

}  // namespace mocurate
