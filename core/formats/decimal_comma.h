#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

/// A table whose numbers have decimal commas, and ';' or tabs between them, with points for commas and blanks for
/// semicolons; empty where commas separate, or there are none. The first line that begins with a number and has a comma
/// decides. Error kMalformed "name:line" where blanks alone separate numbers with one comma each: both are possible.
/// Line ends stay where they are.
Expected<std::optional<std::string>> WithDecimalPoints(std::string_view bytes, const std::string& name);

}  // namespace mocurate
