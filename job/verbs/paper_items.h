#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "job/config_loading.h"

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

}  // namespace mocurate
