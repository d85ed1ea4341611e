#include "core/base/table_text.h"

#include <cmath>
#include <cstdio>

#include "core/base/terminal.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// Whether the text behind leading ' is a formula to a spreadsheet.
bool IsFormula(std::string_view text) {
  const std::size_t first = text.find_first_not_of('\'');
  if (first == std::string_view::npos) return false;
  return std::string_view("=+-@\t\r").find(text[first]) != std::string_view::npos && !ParseDouble(text);
}

std::string InQuotes(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string NoFormula(std::string_view text) { return (IsFormula(text) ? "'" : "") + std::string(text); }

}  // namespace

std::string CsvCell(std::string_view text) {
  const std::string cell = NoFormula(text);
  return cell.find_first_of(",\"\r\n") == std::string::npos ? cell : InQuotes(cell);
}

std::string QuotedCsvCell(std::string_view text) { return InQuotes(NoFormula(text)); }

std::string TextOfCsvCell(std::string_view cell) {
  return std::string(!cell.empty() && cell[0] == '\'' && IsFormula(cell) ? cell.substr(1) : cell);
}

std::optional<std::vector<std::string>> CellsOfCsvLine(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[i++];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  if (quoted) return std::nullopt;
  for (std::string& cell : cells) cell = TextOfCsvCell(Trim(cell));
  return cells;
}

std::string YamlQuoted(std::string_view text) {
  std::string quoted = "\"";
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    if (text.substr(0, 2) == "${") quoted += '$';
    if (character.kind == CharacterKind::kNotUtf8) {
      quoted += "\xEF\xBF\xBD";
    } else if (character.kind == CharacterKind::kControl && character.bytes == 1) {
      quoted += EscapedByte(text[0]);
    } else {
      if (text[0] == '"' || text[0] == '\\') quoted += '\\';
      quoted += text.substr(0, character.bytes);
    }
    text.remove_prefix(character.bytes);
  }
  return quoted + "\"";
}

std::string MarkdownText(std::string_view text) {
  constexpr std::string_view kMarkup = "\\`*_|[]", kMarkupOfLine = "#>+-=";
  std::string escaped;
  for (const char c : TerminalText(Trim(text))) {
    const std::string_view markup = escaped.empty() ? kMarkupOfLine : "";
    if (kMarkup.find(c) != std::string_view::npos || markup.find(c) != std::string_view::npos) escaped += '\\';
    if (c == '<' || c == '&') {
      escaped += c == '<' ? "&lt;" : "&amp;";  // no tag for a reader that takes HTML first
    } else {
      escaped += c == '\n' || c == '\t' ? ' ' : c;
    }
  }
  return escaped;
}

std::string FixedText(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  char buffer[400];
  std::snprintf(buffer, sizeof(buffer), "%.*f", digits, value);
  std::string text = buffer;
  for (char& c : text) {
    if (c == ',') c = '.';
  }
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text[0] == '-' ? text.substr(1) : text;
}

}  // namespace mocurate
