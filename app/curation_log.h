#pragma once

#include <filesystem>
#include <vector>

#include "app/job_items.h"

namespace mocurate {

/// One JSON line per source clip, sorted: kept, left out (by a rule of the configuration), dropped (it failed) or
/// undecided (the run ended before), by which stage and rule, with findings and hashes.
Status WriteCurationLog(const std::vector<ClipRecord>& clips, const std::filesystem::path& path);

}  // namespace mocurate
