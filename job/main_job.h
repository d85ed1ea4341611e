#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "eval/tables/table.h"
#include "job/curation_log.h"
#include "job/job_items.h"
#include "job/job_options.h"
#include "job/job_stage.h"

namespace mocurate {

/// Results of a run; paths are empty for stages that did not run.
struct JobResult {
  std::size_t dataset_clips = 0;
  std::filesystem::path dataset;
  std::filesystem::path report;
  std::vector<std::filesystem::path> tables;
  Table table;
  Table recognition;  ///< of the recognisers
  ClipCounts counts;
  int folders_failed = 0;    ///< of the folders, where ingest.source.other_files is error
  nlohmann::json fit_error;  ///< error against the truth; null without truth
  /// Of fitting.check: {"clips", "of", "differ", "joint_worst_mm", "cost_difference"}; null where the share is 0.
  nlohmann::json check;
  nlohmann::json audit;
  nlohmann::json metrics;
  nlohmann::json training = nlohmann::json::object();  ///< summary of each trained network, by item
  std::map<std::string, Error> ungenerated;            ///< networks whose motions for the page failed, and why, by name
  std::map<std::string, Error> untrained;              ///< networks that could not be trained, and why, by item
  /// Clips with a finding of severity warning or error from ingest, fitting or canon, by its code.
  std::map<std::string, int> findings;
  std::vector<Finding> set_findings;  ///< about the set as a whole: contradicted declarations, splits, rates
  nlohmann::json pages = nlohmann::json::object();    ///< pages of clips, by item
  nlohmann::json viewers = nlohmann::json::object();  ///< pages of the viewer: "clips", "generated"
  std::optional<Error> unevaluated;                   ///< why there is no table, although networks were to be scored
  std::vector<StageCounts> stages;
  std::vector<ClipRecord> clips;
  std::map<std::string, ItemResult> bodies;  ///< of the stage proportions, by item
};

/// ingest -> proportions -> fitting -> canon -> assemble -> audit -> train -> evaluate -> report, each over the
/// runner's workers. Writes dataset.h5, curation_log.jsonl, tables/, metrics.json, report/index.html into the run
/// folder, and removes nothing there (run_file.h). `only`: selected clips (ingest/chosen_clips.h); empty: all.
Expected<JobResult> RunMainJob(const JobOptions& options, JobStage last, Runner& runner,
                               const std::vector<std::string>& only = {});

}  // namespace mocurate
