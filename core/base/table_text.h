#pragma once

#include <string>
#include <string_view>

namespace mocurate {

/// A cell of RFC 4180, in quotes where it needs them. A text that a spreadsheet would compute (it begins with = + - @,
/// a tab or a carriage return and is not a number) begins with ' instead.
std::string CsvCell(std::string_view text);
/// The same, always in quotes.
std::string QuotedCsvCell(std::string_view text);
/// Inverse of the leading ', for a cell without its quotes.
std::string TextOfCsvCell(std::string_view cell);

/// A text in one line of Markdown, with markup and HTML escaped.
std::string MarkdownText(std::string_view text);

}  // namespace mocurate
