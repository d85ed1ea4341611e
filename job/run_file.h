#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "job/config_loading.h"
#include "job/job_stage.h"
#include "job/run_folder.h"

namespace mocurate {

/// An output in a run folder that is not of the run of run.json, and the stage that writes it.
struct StaleOutput {
  std::string file;  ///< below the folder: "dataset.h5"
  std::string stage;
};

/// run.json: the run's program, configuration, place and end, and the outputs of earlier runs of the folder, which stay
/// ("stale": [{"file", "stage"}]). Only this file contains times and hardware.
class RunFile {
 public:
  RunFile(const LoadedJob& job, double budget, JobStage last, const std::filesystem::path& folder);

  /// Written as the run begins; without "ended" the run is at work or was cut short. Error kCannotWrite.
  Status Begin();
  /// Adds time and outcome of the end, and the outputs that were there at the beginning and were not made again, with a
  /// warning. A run that was refused for its configuration before it wrote anything leaves the earlier run.json. Error
  /// kCannotWrite.
  Status End(const Status& outcome);

 private:
  std::vector<StaleOutput> Stale(const std::map<std::string, OutputFile>& now) const;

  std::filesystem::path folder_;
  std::map<std::string, OutputFile> earlier_;  ///< outputs when the run began
  std::string previous_;                       ///< run.json when the run began; empty: none
  nlohmann::json run_;
};

/// The run.json of a folder; null without one written by a run.
nlohmann::json ReadRunFile(const std::filesystem::path& folder);

/// The existing stale outputs of a run folder. Of a run that has not ended, whose run.json is of its begin: those that
/// are older.
std::vector<StaleOutput> StaleOutputs(const std::filesystem::path& folder);
bool IsStale(const std::vector<StaleOutput>& stale, const std::string& file);

/// Notes existing files of a run folder as stale, with a warning, in addition to those of its run.json. Error
/// kCannotWrite.
Status AddStale(const std::filesystem::path& folder, const std::vector<StaleOutput>& stale);

}  // namespace mocurate
