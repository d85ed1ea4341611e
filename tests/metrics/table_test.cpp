// Tables as they are printed.

#include "eval/tables/table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/base/random.h"
#include "core/base/text.h"
#include "eval/tables/run_table.h"

namespace mocurate {
namespace {

/// Accuracies 0.90, 0.92, 0.94: mean 0.92, Student 0.0497, Action2Motion 0.0185, ACTOR 0.0005. FIDs 1, 1, 3, 3.
Table TwoMethods() {
  Table table;
  table.title = "toy";
  table.columns = {"FID", "Accuracy"};
  table.digits = {2, 3};
  table.rows = {{"Real", {{{1.0, 1.0, 3.0, 3.0}}, {{0.90, 0.92, 0.94}}}}, {"Ours, \"new\"", {{{12.5}}, {{}}}}};
  table.notes = {"Three seeds."};
  return table;
}

TEST(Markdown, HasARowPerMethodAndSaysWhatThePlusMinusIs) {
  EXPECT_EQ(ToMarkdown(TwoMethods(), IntervalKind::kStudent),
            "**toy**\n\n"
            "| method | FID | Accuracy |\n"
            "|---|---|---|\n"
            "| Real | 2.00 ± 1.84 | 0.920 ± 0.050 |\n"
            "| Ours, \"new\" | 12.50 | - |\n"
            "\n"
            "± is the half-width of the 95 % interval of the mean (Student t).\n"
            "Three seeds.\n");
}

TEST(Markdown, PrintsEachCodeBasesOwnPlusMinus) {
  const std::string action2motion = ToMarkdown(TwoMethods(), IntervalKind::kAction2Motion);
  EXPECT_NE(action2motion.find("| Real | 2.00 ± 0.98 | 0.920 ± 0.018 |\n"), std::string::npos) << action2motion;
  EXPECT_NE(action2motion.find("\n± is 1.96 sd / sqrt(repetitions), as Action2Motion prints it.\n"), std::string::npos);
  const std::string actor = ToMarkdown(TwoMethods(), IntervalKind::kActor);
  EXPECT_NE(actor.find("| Real | 2.00 ± 1.96 | 0.920 ± 0.001 |\n"), std::string::npos) << actor;
  EXPECT_NE(actor.find("\n± is 1.96 times the variance, as ACTOR prints it: not an interval.\n"), std::string::npos);
}

TEST(Csv, HoldsTheMeanAndAllThreeIntervalsOfEveryCellWithValues) {
  const std::string text = ToCsv(TwoMethods());
  const auto lines = SplitText(text, '\n');
  ASSERT_EQ(lines.size(), 5u);  // the last one is empty
  EXPECT_EQ(lines[0], "method,metric,mean,student_95,action2motion_pm,actor_pm,repetitions");
  const auto fid = SplitText(lines[1], ',');
  ASSERT_EQ(fid.size(), 7u);
  EXPECT_EQ(fid[0], "\"Real\"");
  EXPECT_EQ(fid[1], "\"FID\"");
  EXPECT_EQ(fid[2], "2");
  EXPECT_NEAR(*ParseDouble(fid[3]), 3.182446305284263 / std::sqrt(3.0), 1e-9);
  EXPECT_EQ(fid[4], "0.98");
  EXPECT_EQ(fid[5], "1.96");
  EXPECT_EQ(fid[6], "4");
  EXPECT_EQ(lines[3], "\"Ours, \"\"new\"\"\",\"FID\",12.5,0,0,0,1");
}

TEST(Latex, IsATabularWithTheSameNumbersADashForWhatIsMissingAndTheNotes) {
  EXPECT_EQ(ToLatex(TwoMethods(), IntervalKind::kAction2Motion),
            "% toy\n"
            "\\begin{tabular}{lcc}\n"
            "method & FID & Accuracy \\\\ \\hline\n"
            "Real & $2.00 \\pm 0.98$ & $0.920 \\pm 0.018$ \\\\\n"
            "Ours, \"new\" & $12.50$ & -- \\\\\n"
            "\\end{tabular}\n"
            "\n"
            "\\smallskip{\\footnotesize $\\pm$ is 1.96 sd / sqrt(repetitions), as Action2Motion prints it.\n"
            "Three seeds.}\n");
}

TEST(Latex, ArrowsOfColumnsAreMathematics) {
  Table table = TwoMethods();
  table.columns = {"FID ↓", "Diversity →"};
  EXPECT_NE(ToLatex(table, IntervalKind::kStudent).find("method & FID $\\downarrow$ & Diversity $\\rightarrow$ \\\\"),
            std::string::npos);
}

/// A name of `length` characters of which most mean something to a format.
std::string NastyName(Random& random, int length) {
  constexpr std::string_view kCharacters = "ab_&%|$#{}~^\\<>*`[]\n\"";
  std::string name;
  for (int i = 0; i < length; ++i) name += kCharacters[random.Below(kCharacters.size())];
  return name;
}

/// The text without its escapes; empty when `text` holds a character of `special` that is not escaped.
std::optional<std::string> Unescaped(std::string_view text, std::string_view special) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      plain += text[++i];
    } else if (special.find(text[i]) != std::string_view::npos) {
      return std::nullopt;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

TEST(Markdown, NoNameEndsACellOrBecomesMarkup) {
  Random random(3, "markdown names");
  for (int trial = 0; trial < 200; ++trial) {
    Table table = TwoMethods();
    std::string name = table.rows[0].name = "x" + NastyName(random, 12) + "x";
    std::replace(name.begin(), name.end(), '\n', ' ');
    const auto lines = SplitText(ToMarkdown(table, IntervalKind::kStudent), '\n');
    const std::string row(lines.at(4));
    const std::string end = " | 2.00 ± 1.84 | 0.920 ± 0.050 |";
    ASSERT_EQ(row.substr(0, 2), "| ") << row;
    ASSERT_GT(row.size(), end.size() + 2);
    ASSERT_EQ(row.substr(row.size() - end.size()), end) << row;
    EXPECT_EQ(Unescaped(row.substr(2, row.size() - end.size() - 2), "|*_`<[]"), name) << row;
  }
}

TEST(Latex, NoNameIsTakenForACommand) {
  Random random(4, "latex names");
  const std::pair<std::string, std::string> words[] = {{"\\textbackslash{}", "\\\\"},  {"\\textasciitilde{}", "\\~"},
                                                       {"\\textasciicircum{}", "\\^"}, {"\\textless{}", "\\<"},
                                                       {"\\textgreater{}", "\\>"},     {"\\textbar{}", "\\|"}};
  for (int trial = 0; trial < 200; ++trial) {
    Table table = TwoMethods();
    std::string name = table.rows[0].name = "x" + NastyName(random, 12) + "x";
    std::replace(name.begin(), name.end(), '\n', ' ');
    std::string row(SplitText(ToLatex(table, IntervalKind::kStudent), '\n').at(3));
    const std::string end = " & $2.00 \\pm 1.84$ & $0.920 \\pm 0.050$ \\\\";
    ASSERT_GT(row.size(), end.size());
    ASSERT_EQ(row.substr(row.size() - end.size()), end) << row;
    row.resize(row.size() - end.size());
    for (const auto& [word, character] : words) {
      for (std::size_t at = row.find(word); at != std::string::npos; at = row.find(word, at + 2)) {
        row.replace(at, word.size(), character);
      }
    }
    EXPECT_EQ(Unescaped(row, "&%$#_{}~^<>|"), name) << row;
  }
}

TEST(RunTable, PutsRealFirstAndLeavesAGapForAMetricThatIsMissing) {
  const nlohmann::json metrics = {
      {"rows", {{"Action2Motion", {{"fid", {3.0, 5.0}}}}, {"Real", {{"fid", {1.0}}, {"accuracy", {0.9}}}}}},
      {"notes", {"Three seeds."}}};
  const Table table = RunTable(metrics, "toy");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].name, "Real");
  EXPECT_EQ(table.rows[1].name, "Action2Motion");
  EXPECT_EQ(table.rows[1].cells[0].values, (std::vector<double>{3.0, 5.0}));
  EXPECT_TRUE(table.rows[1].cells[1].values.empty());
  EXPECT_EQ(table.notes, std::vector<std::string>{"Three seeds."});
}

}  // namespace
}  // namespace mocurate
