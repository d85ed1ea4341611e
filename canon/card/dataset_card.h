#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Summary of a dataset: {"name", "file", "bytes", "sha256", "recipe", "created_by", "skeleton", "joints", "rotations",
/// "clips", "frames", "seconds", "classes": [{name, clips, seconds}], "persons": {name: clips}, "sources", "licences",
/// "rates": {name: clips}, "splits": [{name, train, validation, test, rule, leak_check}], "findings": {code: count}}.
/// Read clip by clip. Errors of ReadDataset.
Expected<nlohmann::json> DescribeDataset(const std::filesystem::path& path);

/// The summary as Markdown: a README for the dataset.
std::string CardMarkdown(const nlohmann::json& description);

/// The summary as Croissant metadata (JSON-LD, mlcommons.org/croissant): the file with its hash, the licences of its
/// sources, and the classes as a record set. The publisher adds `url`, `datePublished` and `creator`.
nlohmann::json CardCroissant(const nlohmann::json& description);

}  // namespace mocurate
