#pragma once

#include <nlohmann/json.hpp>

#include "app/job_options.h"
#include "app/verbs.h"

namespace mocurate {

/// A file below the folder MOCURATE_WEIGHTS; empty: the variable is not set, or the file is not there.
std::filesystem::path PublishedFile(const std::filesystem::path& name);

/// Rows of motions that the authors published, for a set of a job: as of ScoreRow, with "profile": "released". Those
/// whose files are not here are left out, and one that cannot be scored with a warning. Error kInterrupted.
Expected<nlohmann::json> ReleasedRows(const ReproduceOptions& item, const std::string& set,
                                      const std::filesystem::path& folder, const CommonArguments& common);

}  // namespace mocurate
