#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "job/main_job.h"

namespace mocurate {

/// Prints a fitted clip: residuals, changes, findings.
void PrintFit(const JobResult& result, const ItemResult& item);

/// Prints the bodies shared by several clips.
void PrintSharedBodies(const JobResult& result);

/// {"output", "clips": [{"clip", "fitted", "error", "fit", "findings"}], "shared_bodies": {body: clips}, "failed"}
nlohmann::json AnswerOf(const JobResult& result, const StageReport& fits, const std::filesystem::path& output);

}  // namespace mocurate
