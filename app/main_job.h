#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/clip_counts.h"
#include "app/job_options.h"
#include "app/job_stage.h"
#include "core/pipeline/runner.h"

namespace mocurate {

/// What a run gave; paths are empty when the run stopped before.
struct JobResult {
  std::size_t dataset_clips = 0;
  std::filesystem::path dataset;
  std::filesystem::path report;
  std::vector<std::filesystem::path> tables;
  std::string table;        ///< Markdown
  std::string recognition;  ///< the same of the recognisers
  ClipCounts counts;
  int folders_failed = 0;    ///< of the folders, where ingest.source.other_files makes them a failure
  nlohmann::json fit_error;  ///< error against the truth, null without truth
  nlohmann::json audit;
  nlohmann::json metrics;
  nlohmann::json training = nlohmann::json::object();  ///< summary of each trained network by its item
  std::map<std::string, Error> ungenerated;            ///< networks whose motions for the page failed, by name
  std::map<std::string, Error> untrained;  ///< networks that were to be trained and why they are not, by item
  /// Clips with a finding of severity warning or error from ingest, fitting or canon, by its code.
  std::map<std::string, int> findings;
  std::vector<Finding> set_findings;  ///< about the set as a whole: against its declaration, splits, rates
  nlohmann::json pages = nlohmann::json::object();  ///< files of the clips that have a page of their own, by item
  std::optional<Error> unevaluated;                 ///< why there is no table although networks were to be scored
  std::vector<StageReport> stages;
};

/// ingest -> proportions -> fitting -> canon -> assemble -> audit -> train -> evaluate -> report, each over the
/// runner's workers. Writes dataset.h5, curation_log.jsonl, tables/, metrics.json, report/index.html into the run
/// folder, and removes from it what an earlier run wrote there and this one does not. A run that ends early says which
/// files of an earlier one are left. `only`: clips that are taken (ingest/chosen_clips.h); empty: all.
Expected<JobResult> RunMainJob(const JobOptions& options, JobStage last, Runner& runner,
                               const std::vector<std::string>& only = {});

}  // namespace mocurate
