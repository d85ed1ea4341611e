#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/config_loading.h"
#include "app/job_stage.h"

namespace mocurate {

/// run.json: what was run, with what, where, and how it ended. Times and hardware live here and nowhere else.
class RunFile {
 public:
  RunFile(const LoadedJob& job, double budget, JobStage last, const std::filesystem::path& folder);

  /// Written as the run begins; without "ended" the run is at work or was cut short. Error kCannotWrite.
  Status Begin();
  /// Adds when the run ended and how. Error kCannotWrite.
  Status End(const Status& outcome);

 private:
  Status Write() const;

  std::filesystem::path path_;
  nlohmann::json run_;
};

/// The run.json of a folder; null when there is none that a run wrote.
nlohmann::json ReadRunFile(const std::filesystem::path& folder);

}  // namespace mocurate
