#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mocurate {

/// Tolerant access to the run summary: parts that a run did not reach are absent there, and absent here.

/// Null when `json` is not an object or lacks the key.
const nlohmann::json& Field(const nlohmann::json& json, const char* key);
/// Empty for anything but an array.
const std::vector<nlohmann::json>& Elements(const nlohmann::json& json);
std::optional<double> NumberOf(const nlohmann::json& json, const char* key);
long long CountOf(const nlohmann::json& json, const char* key);
std::string TextOf(const nlohmann::json& json, const char* key);
/// Finite numbers of an array; NaN for other elements.
std::vector<double> NumbersOf(const nlohmann::json& json);
/// A text, and a count, as cells of a table.
std::string TextCell(const nlohmann::json& json, const char* key);
std::string CountCell(const nlohmann::json& json, const char* key);
/// The number with digits, else an en dash.
std::string NumberCell(const nlohmann::json& json, const char* key, int digits);
/// The number at clips[i]["fitting"][part][key] of all clips that have it; `part` may be empty.
std::vector<double> OverClips(const nlohmann::json& run, const char* part, const char* key);

}  // namespace mocurate
