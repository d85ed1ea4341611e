#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"

/// What a stage gave, in a form that another processor gives too: structure, names and whole numbers of JSON exactly;
/// arrays and long texts by figures that are compared with a tolerance.
namespace mocurate::versions {

/// Record of an artifact. HDF5: every field with shape, type and figures {"mean", "rms", "mix"} (mix: the values
/// weighted by their place, so that exchanged values show). JSON: its values. Other text: its wording apart from the
/// numbers in it. Anything else: its length. Hashes and the program's version are excluded.
Expected<nlohmann::json> RecordArtifact(const std::filesystem::path& artifact);

/// Record of any JSON value, by the same rules.
nlohmann::json RecordJson(const nlohmann::json& value);

/// Places where `actual` differs from `expected` by more than `tolerance` (relative; figures: relative to the rms).
/// Empty when they agree.
std::vector<std::string> Differences(const nlohmann::json& expected, const nlohmann::json& actual, double tolerance);

}  // namespace mocurate::versions
