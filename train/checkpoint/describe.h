#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace mocurate {

/// Whether an HDF5 file says that it is a checkpoint.
bool IsCheckpoint(const std::filesystem::path& path);

/// What a checkpoint is, as JSON: network, progress, classes, skeleton, size, options. Errors of ReadCheckpoint.
Expected<nlohmann::json> DescribeCheckpoint(const std::filesystem::path& path);

}  // namespace mocurate
