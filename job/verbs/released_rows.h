#pragma once

#include <nlohmann/json.hpp>

#include "job/job_options.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// A file below the folder MOCURATE_WEIGHTS; empty without the variable or the file.
std::filesystem::path PublishedFile(const std::filesystem::path& name);

/// Rows of motions published by the authors, for a set of a job: as of ScoreRow, with "profile": "released". Rows with
/// missing files are skipped, and one that cannot be scored with a warning. Error kInterrupted.
Expected<nlohmann::json> ReleasedRows(const ReproduceOptions& item, const std::string& set,
                                      const std::filesystem::path& folder, const CommonArguments& common);

}  // namespace mocurate
