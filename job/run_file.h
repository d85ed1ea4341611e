#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "job/config_loading.h"
#include "job/job_stage.h"

namespace mocurate {

/// run.json: the run's program, configuration, place and end. Only this file contains times and hardware.
class RunFile {
 public:
  RunFile(const LoadedJob& job, double budget, JobStage last, const std::filesystem::path& folder);

  /// Written as the run begins; without "ended" the run is at work or was cut short. Error kCannotWrite.
  Status Begin();
  /// Adds time and outcome of the end. Error kCannotWrite.
  Status End(const Status& outcome);

 private:
  Status Write() const;

  std::filesystem::path path_;
  nlohmann::json run_;
};

/// The run.json of a folder; null without one written by a run.
nlohmann::json ReadRunFile(const std::filesystem::path& folder);

}  // namespace mocurate
