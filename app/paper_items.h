#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/config_loading.h"

namespace mocurate {

/// The name of a kind in lists: "table", "figure", "study", "diagram".
const char* Name(PaperItem kind);

/// The job of a paper's item by its id ("actor/table3"), in a profile ("" for the job's own). Error kUsage for an id
/// that is not there, with the nearest; those of LoadJob.
Expected<LoadedJob> LoadPaperItem(const std::string& id, const std::string& profile,
                                  const std::vector<std::string>& assignments);

/// The options of a paper's item as its config says them, for lists: nothing that its networks need is looked for.
Expected<JobOptions> ReadPaperItem(const std::string& id);

/// "NAME=PATH" of --data into the sets of a job. Error kUsage for a set that the job does not have.
Status TakeData(const std::vector<std::string>& given, JobOptions& options);

/// What an item needs, for lists: {"id", "kind", "shows", "at_hand": [names], "missing": [{"name", "how"}], "profiles":
/// {"smoke": hours, ...}}, hours null where they were not measured.
nlohmann::json DescribePaperItem(const std::string& id, const JobOptions& options);

}  // namespace mocurate
