#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace mocurate {

/// Whether the words of a line, between blanks or semicolons, are digits with one comma among them, or whole numbers,
/// one of them with a comma at least; an exponent may follow.
bool HasDecimalCommas(std::string_view line);

/// The table with points for commas and blanks for semicolons, where its first rows have several words each, of digits
/// with at most one comma each, and have at least two such words in total; empty otherwise. Rows of whole numbers alone
/// are not evidence. Line ends stay where they are.
std::optional<std::string> WithDecimalPoints(std::string_view bytes);

}  // namespace mocurate
