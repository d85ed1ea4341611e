#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "app/main_job.h"

namespace mocurate {

/// A fitted clip, for people: residuals, what changed, findings.
void PrintFit(const JobResult& result, const ItemResult& item);

/// The bodies that several clips were measured and fitted as.
void PrintSharedBodies(const JobResult& result);

/// {"output", "clips": [{"clip", "fitted", "error", "fit", "findings"}], "shared_bodies": {body: clips}, "failed"}
nlohmann::json AnswerOf(const JobResult& result, const StageReport& fits, const std::filesystem::path& output);

}  // namespace mocurate
