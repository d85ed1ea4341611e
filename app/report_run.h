#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/job_items.h"
#include "app/main_job.h"
#include "app/run_outputs.h"
#include "app/stage_runs.h"

namespace mocurate {

/// What a report tells of.
struct ReportedRun {
  const JobOptions& options;
  const std::vector<ClipRecord>& clips;
  const std::map<std::string, ItemResult>& persons;  ///< stage proportions
  const ItemResult& dataset;
  const std::vector<TrainedNetwork>& networks;
  bool fits = false;  ///< clips have pages, videos and pictures of their fits
};

/// Stages clip_video, clip_page, report and picture: writes report/ into the run folder, which must be there, and its
/// page and those of the clips into `result`.
Status WriteReport(const ReportedRun& run, StageRuns& runs, RunOutputs& outputs, JobResult& result);

}  // namespace mocurate
