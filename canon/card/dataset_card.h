#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// What a dataset is, for those who take it: {"name", "file", "bytes", "sha256", "recipe", "created_by", "skeleton",
/// "joints", "rotations", "clips", "frames", "seconds", "classes": [{name, clips, seconds}], "persons": {name: clips},
/// "sources", "licences", "rates": {name: clips}, "splits": [{name, train, validation, test, rule, leak_check}],
/// "findings": {code: count}}. Read clip by clip. Errors of ReadDataset.
Expected<nlohmann::json> DescribeDataset(const std::filesystem::path& path);

/// That as Markdown: a README for the dataset.
std::string CardMarkdown(const nlohmann::json& description);

/// That in Croissant's words (JSON-LD, mlcommons.org/croissant): the file with its hash, the licences of its sources,
/// and the classes as a record set. `url`, `datePublished` and `creator` are whoever's who publishes it to add.
nlohmann::json CardCroissant(const nlohmann::json& description);

}  // namespace mocurate
