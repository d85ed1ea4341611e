#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"

/// Output of a stage in a form that does not depend on the processor: structure, names and whole numbers of JSON
/// exactly; arrays and long texts as statistics that are compared with a tolerance.
namespace mocurate::versions {

/// Record of an artifact. HDF5: every field with shape, type and figures {"mean", "rms", "mix"} (mix: the values
/// weighted by position, so that exchanged values are detected). JSON: its values. Other text: its wording without the
/// numbers. Anything else: its length. A folder: its pages, and the lengths of its
/// other files. Hashes and the program's version are not recorded.
Expected<nlohmann::json> RecordArtifact(const std::filesystem::path& artifact);

/// Record of any JSON value, by the same rules.
nlohmann::json RecordJson(const nlohmann::json& value);

/// Places where `actual` differs from `expected` by more than `tolerance` (relative; figures: relative to the rms).
/// Empty when they agree.
std::vector<std::string> Differences(const nlohmann::json& expected, const nlohmann::json& actual, double tolerance);

}  // namespace mocurate::versions
