#pragma once

#include <filesystem>
#include <vector>

#include "app/job_items.h"

namespace mocurate {

/// One JSON line per source clip, sorted: kept or dropped, by which stage and rule, with value and hashes.
Status WriteCurationLog(const std::vector<ClipRecord>& clips, const std::filesystem::path& path);

}  // namespace mocurate
