#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Whether files may be written: each has its own path, is neither an input nor inside a folder that is read, and does
/// not exist unless `force`. Empty paths are skipped. Error kUsage.
Status CheckOutputs(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs,
                    bool force);

}  // namespace mocurate
