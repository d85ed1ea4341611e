#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

/// TOML 1.0 as a JSON value: tables, arrays of tables, dotted and quoted keys, one-line strings, numbers, booleans,
/// arrays over several lines, inline tables. Error kMalformed "name:line" for what breaks the grammar, a key that comes
/// twice and numbers that are not finite; kUnsupported for dates and strings over several lines.
Expected<nlohmann::json> ParseToml(std::string_view bytes, const std::string& name);

}  // namespace mocurate
