#include "eval/tables/table.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

std::string Fixed(double value, int digits) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.*f", digits, value);
  for (char& c : buffer) {
    if (c == ',') c = '.';
  }
  return buffer;
}

/// "0.920 ± 0.050"; the cell has values.
std::string CellText(const Table::Cell& cell, int digits, IntervalKind interval, const char* plus_minus) {
  const Summary summary = Summarise(cell.values, interval);
  std::string text = Fixed(summary.mean, digits);
  if (cell.values.size() > 1) text += plus_minus + Fixed(summary.half_width, digits);
  return text;
}

const char* Meaning(IntervalKind interval) {
  switch (interval) {
    case IntervalKind::kStudent:
      return "± is the half-width of the 95 % interval of the mean (Student t)";
    case IntervalKind::kAction2Motion:
      return "± is 1.96 sd / sqrt(repetitions), as Action2Motion prints it";
    case IntervalKind::kActor:
      return "± is 1.96 times the variance, as ACTOR prints it: not an interval";
  }
  return "";
}

std::string CsvText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// A name in one line of Markdown: what would be markup, or end a cell, is escaped.
std::string MarkdownText(std::string_view text) {
  constexpr std::string_view kMarkup = "\\`*_|<[]";
  std::string escaped;
  for (const char c : text) {
    if (kMarkup.find(c) != std::string_view::npos) escaped += '\\';
    escaped += c == '\n' || c == '\r' ? ' ' : c;
  }
  return escaped;
}

/// A name in LaTeX text, with the arrows and signs of our columns and notes.
std::string LatexText(std::string_view text) {
  constexpr std::pair<std::string_view, std::string_view> kReplaced[] = {{"\\", "\\textbackslash{}"},
                                                                         {"~", "\\textasciitilde{}"},
                                                                         {"^", "\\textasciicircum{}"},
                                                                         {"<", "\\textless{}"},
                                                                         {">", "\\textgreater{}"},
                                                                         {"|", "\\textbar{}"},
                                                                         {"&", "\\&"},
                                                                         {"%", "\\%"},
                                                                         {"$", "\\$"},
                                                                         {"#", "\\#"},
                                                                         {"_", "\\_"},
                                                                         {"{", "\\{"},
                                                                         {"}", "\\}"},
                                                                         {"↓", "$\\downarrow$"},
                                                                         {"↑", "$\\uparrow$"},
                                                                         {"→", "$\\rightarrow$"},
                                                                         {"±", "$\\pm$"},
                                                                         {"\n", " "},
                                                                         {"\r", " "}};
  std::string escaped;
  while (!text.empty()) {
    const auto* found = std::find_if(std::begin(kReplaced), std::end(kReplaced), [&](const auto& replaced) {
      return text.substr(0, replaced.first.size()) == replaced.first;
    });
    const bool plain = found == std::end(kReplaced);
    escaped += plain ? text.substr(0, 1) : found->second;
    text.remove_prefix(plain ? 1 : found->first.size());
  }
  return escaped;
}

}  // namespace

std::string ToMarkdown(const Table& table, IntervalKind interval) {
  std::string text = "**" + MarkdownText(table.title) + "**\n\n| method |";
  for (const std::string& column : table.columns) text += " " + MarkdownText(column) + " |";
  text += "\n|---|";
  for (std::size_t c = 0; c < table.columns.size(); ++c) text += "---|";
  text += "\n";
  for (const Table::Row& row : table.rows) {
    text += "| " + MarkdownText(row.name) + " |";
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Table::Cell& cell = row.cells[c];
      text += " " + (cell.values.empty() ? "-" : CellText(cell, table.digits[c], interval, " ± ")) + " |";
    }
    text += "\n";
  }
  text += "\n" + std::string(Meaning(interval)) + ".\n";
  for (const std::string& note : table.notes) text += MarkdownText(note) + "\n";
  return text;
}

std::string ToCsv(const Table& table) {
  std::string text = "method,metric,mean,student_95,action2motion_pm,actor_pm,repetitions\n";
  for (const Table::Row& row : table.rows) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const std::vector<double>& values = row.cells[c].values;
      if (values.empty()) continue;
      text += CsvText(row.name) + "," + CsvText(table.columns[c]) + "," +
              FormatDouble(Summarise(values, IntervalKind::kStudent).mean);
      for (const IntervalKind kind : {IntervalKind::kStudent, IntervalKind::kAction2Motion, IntervalKind::kActor}) {
        text += "," + FormatDouble(Summarise(values, kind).half_width);
      }
      text += "," + std::to_string(values.size()) + "\n";
    }
  }
  return text;
}

std::string ToLatex(const Table& table, IntervalKind interval) {
  std::string text =
      "% " + LatexText(table.title) + "\n\\begin{tabular}{l" + std::string(table.columns.size(), 'c') + "}\nmethod";
  for (const std::string& column : table.columns) text += " & " + LatexText(column);
  text += " \\\\ \\hline\n";
  for (const Table::Row& row : table.rows) {
    text += LatexText(row.name);
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Table::Cell& cell = row.cells[c];
      text += cell.values.empty() ? " & --" : " & $" + CellText(cell, table.digits[c], interval, " \\pm ") + "$";
    }
    text += " \\\\\n";
  }
  text += "\\end{tabular}\n\n\\smallskip{\\footnotesize " + LatexText(Meaning(interval)) + ".";
  for (const std::string& note : table.notes) text += "\n" + LatexText(note);
  return text + "}\n";
}

}  // namespace mocurate
