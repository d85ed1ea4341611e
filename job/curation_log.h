#pragma once

#include <filesystem>
#include <vector>

#include "job/job_items.h"

namespace mocurate {

/// One JSON line per source clip, sorted: kept, excluded (by a rule of the configuration), dropped (it failed) or
/// undecided (the run ended before), with stage, rule, findings and hashes.
Status WriteCurationLog(const std::vector<ClipRecord>& clips, const std::filesystem::path& path);

}  // namespace mocurate
