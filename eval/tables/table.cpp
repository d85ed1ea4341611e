#include "eval/tables/table.h"

#include <cstdio>

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

std::string CellText(const Table::Cell& cell, int digits, IntervalKind interval, const char* plus_minus) {
  if (cell.values.empty()) return "-";
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

}  // namespace

std::string ToMarkdown(const Table& table, IntervalKind interval) {
  std::string text = "**" + table.title + "**\n\n| method |";
  for (const std::string& column : table.columns) text += " " + column + " |";
  text += "\n|---|";
  for (std::size_t c = 0; c < table.columns.size(); ++c) text += "---|";
  text += "\n";
  for (const Table::Row& row : table.rows) {
    text += "| " + row.name + " |";
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      text += " " + CellText(row.cells[c], table.digits[c], interval, " ± ") + " |";
    }
    text += "\n";
  }
  text += "\n" + std::string(Meaning(interval)) + ".\n";
  for (const std::string& note : table.notes) text += note + "\n";
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
  std::string text = "% " + table.title + "\n\\begin{tabular}{l" + std::string(table.columns.size(), 'c') + "}\nmethod";
  for (const std::string& column : table.columns) text += " & " + column;
  text += " \\\\ \\hline\n";
  for (const Table::Row& row : table.rows) {
    text += row.name;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      text += " & $" + CellText(row.cells[c], table.digits[c], interval, " \\pm ") + "$";
    }
    text += " \\\\\n";
  }
  return text + "\\end{tabular}\n";
}

}  // namespace mocurate
