#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Files and folders that mocurate itself writes: stores (datasets, evidence, truth), checkpoints, run folders.

/// Whether a path is one of them.
bool IsMade(const std::filesystem::path& path);

/// As JSON; errors of reading.
Expected<nlohmann::json> DescribeMade(const std::filesystem::path& path);

/// The same as a few lines of text.
std::string MadeText(const std::filesystem::path& path, const nlohmann::json& description);

}  // namespace mocurate
