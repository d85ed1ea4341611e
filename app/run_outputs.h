#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "app/job_stage.h"
#include "core/base/error.h"

namespace mocurate {

/// The files that runs write into their folder, each known by its name and the stage that writes it. What an earlier
/// run left there and this run does not write can be removed, so that no figure stands beside options that it was not
/// made with. Files with other names are never touched; neither are the synthetic capture and the record of runs
/// (run.json, journal.jsonl, lock).
class RunOutputs {
 public:
  explicit RunOutputs(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Where the output `name` (below the run folder) belongs; it counts as this run's from now on.
  std::filesystem::path Place(const std::string& name);

  /// Removes outputs of the stages `first` to `last` that are not this run's, and folders that are empty without them.
  /// Error kCannotWrite.
  Status RemoveLeftovers(JobStage first, JobStage last) const;

  /// Names what is left in the folder that is not this run's: for a run that ends early. It removes nothing, so that a
  /// mistyped option costs nothing.
  void WarnOfLeftovers() const;

  /// What is there of the stages `first` to `last` that is not this run's, in order of name.
  std::vector<std::string> Leftovers(JobStage first, JobStage last) const;

 private:
  std::filesystem::path folder_;
  std::set<std::string> placed_;
};

/// The files of a folder that bear a name of ours, the record of runs (run.json, journal.jsonl, lock) and the list of
/// the capture among them; below the folder, in order of name.
std::vector<std::string> RunFilesIn(const std::filesystem::path& folder);

/// The last entry of each item of a stage that did its work, as the journal of a run tells it.
std::map<std::string, nlohmann::json> JournalOf(const std::filesystem::path& folder, const std::string& stage);

/// Copies a file so that it appears whole.
Status CopyWhole(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace mocurate
