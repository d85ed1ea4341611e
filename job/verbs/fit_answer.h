#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "job/main_job.h"

namespace mocurate {

bool IsFitted(const ClipRecord& clip);

/// Prints a fitted clip: residuals, changes, findings.
void PrintFit(const ClipRecord& clip);

/// Prints the bodies shared by several clips.
void PrintSharedBodies(const JobResult& result);

/// {"output", "clips": [{"clip", "fitted", "error", "fit", "findings"}], "findings": `of_set`, "shared_bodies": {body:
/// clips}, "failed"}
nlohmann::json AnswerOf(const JobResult& result, const std::filesystem::path& output,
                        const std::vector<Finding>& of_set);

}  // namespace mocurate
