#include "eval/tables/table.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// "0.920 ± 0.050"; the cell has a value.
std::string CellText(const Table::Cell& cell, int digits, const char* plus_minus, const char* mark) {
  std::string text = FixedText(*cell.value, digits);
  if (cell.interval) text += plus_minus + FixedText(0.5 * ((*cell.interval)[1] - (*cell.interval)[0]), digits);
  return text + (cell.marked ? mark : "");
}

/// The meaning of each interval in the table, in order of appearance.
std::vector<std::string> Meanings(const Table& table) {
  constexpr std::pair<std::string_view, std::string_view> kMeanings[] = {
      {"student_95", "± (student_95) is the half-width of the 95 % interval of the mean, Student t"},
      {"a2m_1.96_sd_over_sqrt_n", "± (a2m) is 1.96 sd / sqrt(repetitions), as Action2Motion prints it"},
      {"actor_1.96_variance", "± (actor) is 1.96 times the variance, as ACTOR prints it: not an interval"},
      {"motions_95", "± (motions_95) is half the width of the 95 % interval over other motions"},
      {"persons_95", "± (persons_95) is half the width of the 95 % interval over other persons"},
      {"range_of_seeds", "± (range_of_seeds) is half the range of the seeds' trainings about their mean"},
      {"spread", "± (spread) is of these motions: fewer than 10 persons, or persons that are not known"}};
  std::vector<std::string> meanings;
  bool marked = false, unconverged = false, given_pose = false;
  for (const Table::Row& row : table.rows) {
    unconverged = unconverged || row.unconverged;
    given_pose = given_pose || row.given_pose;
    for (const Table::Cell& cell : row.cells) {
      marked = marked || cell.marked;
      for (const auto& [kind, meaning] : kMeanings) {
        const std::string text(meaning);
        const bool known = std::find(meanings.begin(), meanings.end(), text) != meanings.end();
        if (cell.interval && cell.interval_kind == kind && !known) meanings.push_back(text);
      }
    }
  }
  if (marked) meanings.emplace_back("† lies outside the published interval");
  if (unconverged) meanings.emplace_back("‡ has not converged: longer training may change the values");
  if (given_pose) meanings.emplace_back("§ was given the first pose of a real motion: not ranked");
  return meanings;
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
                                                                         {"†", "$\\dagger$"},
                                                                         {"‡", "$\\ddagger$"},
                                                                         {"§", "\\S{}"},
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

std::vector<std::vector<std::string>> CellTexts(const Table& table) {
  std::vector<std::vector<std::string>> texts = {{table.first}};
  texts[0].insert(texts[0].end(), table.columns.begin(), table.columns.end());
  for (const Table::Row& row : table.rows) {
    const std::string source = row.source.empty() ? "" : " (" + row.source + ")";
    texts.push_back({row.name + (row.unconverged ? " ‡" : "") + (row.given_pose ? " §" : "") + source});
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Table::Cell& cell = row.cells[c];
      texts.back().push_back(cell.value ? CellText(cell, table.digits[c], " ± ", "†") : "-");
    }
  }
  return texts;
}

std::vector<std::string> LinesBelow(const Table& table) {
  std::vector<std::string> lines = Meanings(table);
  for (std::string& line : lines) line += ".";
  lines.insert(lines.end(), table.notes.begin(), table.notes.end());
  return lines;
}

std::string ToMarkdown(const Table& table) {
  std::string text = "**" + MarkdownText(table.title) + "**\n\n";
  const std::vector<std::vector<std::string>> rows = CellTexts(table);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += "|";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const bool value = r > 0 && c > 0;  // numbers and dashes need no escapes
      text += " " + (value ? rows[r][c] : MarkdownText(rows[r][c])) + " |";
    }
    text += "\n";
    if (r > 0) continue;
    text += "|";
    for (std::size_t c = 0; c < rows[r].size(); ++c) text += "---|";
    text += "\n";
  }
  text += "\n";
  for (const std::string& meaning : Meanings(table)) text += meaning + ".\n";
  for (const std::string& note : table.notes) text += MarkdownText(note) + "\n";
  return text;
}

std::string ToCsv(const Table& table) {
  std::string text =
      "method,metric,value,interval_low,interval_high,interval_kind,student_95,action2motion_pm,actor_pm,repetitions,"
      "source,converged\n";
  for (const Table::Row& row : table.rows) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Table::Cell& cell = row.cells[c];
      if (!cell.value) continue;
      text += QuotedCsvCell(row.name) + "," + QuotedCsvCell(table.columns[c]) + "," + FormatDouble(*cell.value) + ",";
      text += cell.interval ? FormatDouble((*cell.interval)[0]) + "," + FormatDouble((*cell.interval)[1]) : ",";
      text += "," + cell.interval_kind;
      for (const IntervalKind kind : {IntervalKind::kStudent, IntervalKind::kAction2Motion, IntervalKind::kActor}) {
        text += "," + (cell.repetitions.size() > 1 ? FormatDouble(Summarise(cell.repetitions, kind).half_width) : "");
      }
      text += "," + std::to_string(std::max<std::size_t>(1, cell.repetitions.size())) + "," +
              QuotedCsvCell(row.source) + "," + (row.unconverged ? "no" : "") + "\n";
    }
  }
  return text;
}

std::string ToLatex(const Table& table) {
  std::string text = "% " + LatexText(table.title) + "\n\\begin{tabular}{l" + std::string(table.columns.size(), 'c') +
                     "}\n\\toprule\nmethod";
  for (const std::string& column : table.columns) text += " & " + LatexText(column);
  text += " \\\\\n\\midrule\n";
  bool published = false;
  for (const Table::Row& row : table.rows) {
    if (!row.source.empty() && !published) text += "\\midrule\n";
    published = published || !row.source.empty();
    text += LatexText(row.name) + (row.unconverged ? "$^\\ddagger$" : "") + (row.given_pose ? "$^\\S$" : "") +
            (row.source.empty() ? "" : " (" + LatexText(row.source) + ")");
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Table::Cell& cell = row.cells[c];
      text += cell.value ? " & $" + CellText(cell, table.digits[c], " \\pm ", "^\\dagger") + "$" : " & --";
    }
    text += " \\\\\n";
  }
  text += "\\bottomrule\n\\end{tabular}\n\n\\smallskip{\\footnotesize";
  const std::vector<std::string> lines = LinesBelow(table);
  for (std::size_t i = 0; i < lines.size(); ++i) text += (i == 0 ? " " : "\n") + LatexText(lines[i]);
  return text + "}\n";
}

}  // namespace mocurate
