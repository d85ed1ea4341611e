#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "job/job_items.h"
#include "job/main_job.h"
#include "job/stage_runs.h"

namespace mocurate {

/// Input of a report.
struct ReportedRun {
  const JobOptions& options;
  const std::vector<ClipRecord>& clips;
  const std::map<std::string, ItemResult>& persons;  ///< stage proportions
  const ItemResult& dataset;
  const ItemResult& audit;
  const std::vector<StageInput>& truth;
  const std::vector<TrainedNetwork>& networks;
  bool fits = false;  ///< clips have pages, videos and pictures of their fits
};

/// Counts of a stage: {"stage", "branch", "items", "done", "suspect", "excluded", "refused", "crashed"}.
nlohmann::json StageSummary(const StageCounts& stage);

/// Stages clip_video, clip_page, view and report: writes report/ into the existing run `folder`, and adds the paths
/// of its page and of the clips' pages to `result`.
Status WriteReport(const ReportedRun& run, StageRuns& runs, const std::filesystem::path& folder, JobResult& result);

}  // namespace mocurate
