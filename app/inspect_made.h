#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// What mocurate itself made: stores (datasets, evidence, truth), checkpoints, run folders.

/// Whether a path is one of them.
bool IsMade(const std::filesystem::path& path);

/// As JSON; errors of what reads it.
Expected<nlohmann::json> DescribeMade(const std::filesystem::path& path);

/// The same in a few lines for a person.
std::string MadeText(const std::filesystem::path& path, const nlohmann::json& description);

}  // namespace mocurate
