#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "job/job_stage.h"

namespace mocurate {

/// The files that runs write into their folder, each with its name and the stage that writes it. Files that an earlier
/// run wrote and this run does not can be removed, so that no result is beside options of another run. Files with other
/// names are never changed; neither are the synthetic capture and the record of runs (run.json, journal.jsonl, lock).
class RunOutputs {
 public:
  explicit RunOutputs(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Path of the output `name` (below the run folder); from now on it counts as this run's.
  std::filesystem::path Place(const std::string& name);

  /// Removes outputs of the stages `first` to `last` that are not this run's, and then empty folders. Error
  /// kCannotWrite.
  Status RemoveLeftovers(JobStage first, JobStage last) const;

  /// Warns of remaining files that are not this run's, for a run that ends early. Removes nothing, so that a mistyped
  /// option has no effect on them.
  void WarnOfLeftovers() const;

  /// Existing outputs of the stages `first` to `last` that are not this run's, in order of name.
  std::vector<std::string> Leftovers(JobStage first, JobStage last) const;

 private:
  std::filesystem::path folder_;
  std::set<std::string> placed_;
};

/// The files of a folder that have the name of an output, including the record of runs (run.json, journal.jsonl, lock)
/// and the list of the capture; relative to the folder, in order of name.
std::vector<std::string> RunFilesIn(const std::filesystem::path& folder);

/// The last journal entry of each item of a stage that was processed.
std::map<std::string, nlohmann::json> JournalOf(const std::filesystem::path& folder, const std::string& stage);

/// Copies a file atomically: it appears complete.
Status CopyWhole(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace mocurate
