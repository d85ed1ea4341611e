#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace mocurate {

/// Whether an HDF5 file is declared as a checkpoint.
bool IsCheckpoint(const std::filesystem::path& path);

/// Summary of a checkpoint as JSON: network, progress, classes, skeleton, size, options. Errors of ReadCheckpoint.
Expected<nlohmann::json> DescribeCheckpoint(const std::filesystem::path& path);

}  // namespace mocurate
