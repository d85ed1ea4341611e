#pragma once

#include <filesystem>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Whether files may be written: each is a place of its own, none of the inputs nor a file in a
/// folder that is read, and is not there yet unless `force`.
/// Empty paths are passed over. Error kUsage.
Status CheckOutputs(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs,
                    bool force);

}  // namespace mocurate
