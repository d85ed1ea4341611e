#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace mocurate {

/// Whether the words of a line, between blanks or semicolons, are digits with one comma among them, or whole numbers.
bool HasDecimalCommas(std::string_view line);

/// The table with points for commas and blanks for semicolons, where each of its first rows of digits has decimal
/// commas in two words or more; nothing otherwise. Line ends stay where they are.
std::optional<std::string> WithDecimalPoints(std::string_view bytes);

}  // namespace mocurate
