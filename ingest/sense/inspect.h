#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "core/base/error.h"
#include "ingest/options.h"

namespace mocurate {

/// What a file or folder is: {"path", "format", "clips": [...], "findings": [...]}; each value of a clip is an object
/// {"value", "from": declared | measured | unknown, "confidence", "evidence"}. docs/inspect.md is the contract. With a
/// source declaration its statements are compared with the data. A file that cannot be read gives no clips and a
/// finding of severity error.
nlohmann::json InspectPath(const std::filesystem::path& path, const std::optional<SourceOptions>& source);

/// The same as text for a person.
std::string InspectionText(const nlohmann::json& inspection);

}  // namespace mocurate
