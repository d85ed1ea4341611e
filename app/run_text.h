#pragma once

#include "app/main_job.h"

namespace mocurate {

/// Items that the run has done, or that a dry run says would be done.
int Executed(const JobResult& result);

/// On stdout: the stages, what became of the clips, figures, and where things are.
void PrintResult(const JobResult& result, double seconds);

/// On stdout: per stage what would run and what the cache serves.
void PrintForeseen(const JobResult& result, JobStage last);

}  // namespace mocurate
