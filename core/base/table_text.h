#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// A cell of RFC 4180, in quotes where it needs them. A text that a spreadsheet would compute (it begins with = + - @,
/// a tab or a carriage return and is not a number) begins with ' instead.
std::string CsvCell(std::string_view text);
/// The same, always in quotes.
std::string QuotedCsvCell(std::string_view text);
/// Inverse of the leading ', for a cell without its quotes.
std::string TextOfCsvCell(std::string_view cell);
/// Texts of a line: those in quotes may hold commas, "" in them is a quote. Nothing where a quote is left open.
std::optional<std::vector<std::string>> CellsOfCsvLine(std::string_view line);

/// A text in double quotes that YAML reads back as itself: "${" is no reference, bytes that are not UTF-8 become
/// U+FFFD.
std::string YamlQuoted(std::string_view text);

/// A text in one line of Markdown, with markup and HTML escaped.
std::string MarkdownText(std::string_view text);

/// Fixed digits with a point in any locale; an en dash for non-finite values.
std::string FixedText(double value, int digits);

}  // namespace mocurate
