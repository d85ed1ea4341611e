#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "job/config_loading.h"
#include "job/job_options.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// Name of a kind in lists: "table", "figure", "study", "diagram".
const char* Name(PaperItem kind);

/// The job of a paper's item by its id ("actor/table3"), in a profile ("": the job's own). Error kUsage with the
/// nearest id for an unknown one; those of LoadJob.
Expected<LoadedJob> LoadPaperItem(const std::string& id, const std::string& profile,
                                  const std::vector<std::string>& assignments);

/// The options of a paper's item as in its config, for lists; files of its networks are not searched.
Expected<JobOptions> ReadPaperItem(const std::string& id);

/// Sets the paths of a job's sets from "NAME=PATH" of --data. Error kUsage for an unknown set.
Status TakeData(const std::vector<std::string>& given, JobOptions& options);

/// Requirements of an item, for lists: {"id", "kind", "shows", "at_hand": [names], "missing": [{"name", "how"}],
/// "profiles": {"smoke": hours, ...}}, hours null where they were not measured.
nlohmann::json DescribePaperItem(const std::string& id, const JobOptions& options);

/// A file below the folder MOCURATE_WEIGHTS; empty without the variable or the file.
std::filesystem::path PublishedFile(const std::filesystem::path& name);

/// Rows of motions published by the authors, for a set of a job: as of ScoreRow, with "profile": "released". Rows with
/// missing files are skipped, and one that cannot be scored with a warning. Error kInterrupted.
Expected<nlohmann::json> ReleasedRows(const ReproduceOptions& item, const std::string& set,
                                      const std::filesystem::path& folder, const CommonArguments& common);

}  // namespace mocurate
