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
#include "eval/published/published.h"
#include "eval/tables/result_table.h"

namespace mocurate {
namespace {

Table::Cell Cell(double value, double half_width, IntervalKind kind, std::vector<double> repetitions = {}) {
  Table::Cell cell;
  cell.value = value;
  if (half_width > 0.0) cell.interval = {value - half_width, value + half_width};
  cell.interval_kind = Name(kind);
  cell.repetitions = std::move(repetitions);
  return cell;
}

/// Our rows with each kind of interval and without one, and a published row.
Table TwoMethods() {
  Table table;
  table.title = "toy";
  table.columns = {"FID", "Accuracy"};
  table.digits = {2, 3};
  table.rows = {
      {"Real",
       {Cell(2.0, 1.84, IntervalKind::kStudent, {1.0, 1.0, 3.0, 3.0}), Cell(0.92, 0.05, IntervalKind::kStudent)},
       ""},
      {"Ours, \"new\"", {Cell(12.5, 0.0, IntervalKind::kStudent), {}}, ""},
      {"Ours", {Cell(2.458, 0.079, IntervalKind::kAction2Motion), {}}, "a paper, Table 1"}};
  table.rows[1].cells[0].marked = true;
  table.notes = {"Three seeds."};
  return table;
}

TEST(Markdown, HasARowPerMethodAndExplainsThePlusMinus) {
  EXPECT_EQ(ToMarkdown(TwoMethods()),
            "**toy**\n\n"
            "| method | FID | Accuracy |\n"
            "|---|---|---|\n"
            "| Real | 2.00 ± 1.84 | 0.920 ± 0.050 |\n"
            "| Ours, \"new\" | 12.50† | - |\n"
            "| Ours (a paper, Table 1) | 2.46 ± 0.08 | - |\n"
            "\n"
            "± (student_95) is the half-width of the 95 % interval of the mean, Student t.\n"
            "± (a2m) is 1.96 sd / sqrt(repetitions), as Action2Motion prints it.\n"
            "† lies outside the published interval.\n"
            "Three seeds.\n");
}

TEST(Csv, HasTheValueItsIntervalAndThePapersValues) {
  const std::string text = ToCsv(TwoMethods());
  const auto lines = SplitText(text, '\n');
  ASSERT_EQ(lines.size(), 6u);  // the last one is empty
  EXPECT_EQ(lines[0],
            "method,metric,value,interval_low,interval_high,interval_kind,student_95,action2motion_pm,actor_pm,"
            "repetitions,source,converged");
  const auto fid = SplitText(lines[1], ',');
  ASSERT_EQ(fid.size(), 12u);
  EXPECT_EQ(fid[0], "\"Real\"");
  EXPECT_EQ(fid[2], "2");
  EXPECT_NEAR(*ParseDouble(fid[6]), 3.182446305284263 / std::sqrt(3.0), 1e-9);
  EXPECT_EQ(fid[7], "0.98");
  EXPECT_EQ(fid[8], "1.96");
  EXPECT_EQ(fid[9], "4");
  EXPECT_EQ(lines[3], "\"Ours, \"\"new\"\"\",\"FID\",12.5,,,student_95,,,,1,\"\",");
}

TEST(Csv, HoldsNoFormula) {
  Table table = TwoMethods();
  table.rows[0].name = "=HYPERLINK(\"http://a\")";
  EXPECT_EQ(ToCsv(table).find("\n\"="), std::string::npos);
}

TEST(Latex, IsABooktabsTabularWithDashesForMissingValuesAndNotes) {
  EXPECT_EQ(ToLatex(TwoMethods()),
            "% toy\n"
            "\\begin{tabular}{lcc}\n"
            "\\toprule\n"
            "method & FID & Accuracy \\\\\n"
            "\\midrule\n"
            "Real & $2.00 \\pm 1.84$ & $0.920 \\pm 0.050$ \\\\\n"
            "Ours, \"new\" & $12.50^\\dagger$ & -- \\\\\n"
            "\\midrule\n"
            "Ours (a paper, Table 1) & $2.46 \\pm 0.08$ & -- \\\\\n"
            "\\bottomrule\n"
            "\\end{tabular}\n"
            "\n"
            "\\smallskip{\\footnotesize $\\pm$ (student\\_95) is the half-width of the 95 \\% interval of the mean, "
            "Student t.\n"
            "$\\pm$ (a2m) is 1.96 sd / sqrt(repetitions), as Action2Motion prints it.\n"
            "$\\dagger$ lies outside the published interval.\n"
            "Three seeds.}\n");
}

TEST(Latex, WritesArrowsOfColumnsAsMathematics) {
  Table table = TwoMethods();
  table.columns = {"FID ↓", "Diversity →"};
  EXPECT_NE(ToLatex(table).find("method & FID $\\downarrow$ & Diversity $\\rightarrow$ \\\\"), std::string::npos);
}

/// A name of `length` characters, most of which are special in a format.
std::string NastyName(Random& random, int length) {
  constexpr std::string_view kCharacters = "ab_&%|$#{}~^\\<>*`[]\n\"";
  std::string name;
  for (int i = 0; i < length; ++i) name += kCharacters[random.Below(kCharacters.size())];
  return name;
}

/// The text without its escapes; empty if `text` has a character of `special` that is not escaped.
std::optional<std::string> Unescaped(std::string_view text, std::string_view special) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      plain += text[++i];
    } else if (text.substr(i, 4) == "&lt;") {
      plain += '<';
      i += 3;
    } else if (text.substr(i, 5) == "&amp;") {
      plain += '&';
      i += 4;
    } else if (special.find(text[i]) != std::string_view::npos) {
      return std::nullopt;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

TEST(Markdown, EscapesNames) {
  Random random(3, "markdown names");
  for (int trial = 0; trial < 200; ++trial) {
    Table table = TwoMethods();
    std::string name = table.rows[0].name = "x" + NastyName(random, 12) + "x";
    std::replace(name.begin(), name.end(), '\n', ' ');
    const auto lines = SplitText(ToMarkdown(table), '\n');
    const std::string row(lines.at(4));
    const std::string end = " | 2.00 ± 1.84 | 0.920 ± 0.050 |";
    ASSERT_EQ(row.substr(0, 2), "| ") << row;
    ASSERT_GT(row.size(), end.size() + 2);
    ASSERT_EQ(row.substr(row.size() - end.size()), end) << row;
    EXPECT_EQ(Unescaped(row.substr(2, row.size() - end.size() - 2), "|*_`<[]"), name) << row;
  }
}

TEST(Latex, EscapesNames) {
  Random random(4, "latex names");
  const std::pair<std::string, std::string> words[] = {{"\\textbackslash{}", "\\\\"},  {"\\textasciitilde{}", "\\~"},
                                                       {"\\textasciicircum{}", "\\^"}, {"\\textless{}", "\\<"},
                                                       {"\\textgreater{}", "\\>"},     {"\\textbar{}", "\\|"}};
  for (int trial = 0; trial < 200; ++trial) {
    Table table = TwoMethods();
    std::string name = table.rows[0].name = "x" + NastyName(random, 12) + "x";
    std::replace(name.begin(), name.end(), '\n', ' ');
    std::string row(SplitText(ToLatex(table), '\n').at(5));
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

nlohmann::json Metric(double value) {
  return {{"value", value}, {"interval", {value - 0.1, value + 0.1}}, {"interval_kind", "student_95"}};
}

nlohmann::json Result() {
  const nlohmann::json none = {{"value", nullptr}, {"interval", nullptr}, {"interval_kind", nullptr}};
  return {{"rows",
           {{{"name", "Real"}, {"metrics", {{"FID_train", Metric(0.1)}, {"accuracy", Metric(0.9)}, {"KID", none}}}},
            {{"name", "Ours"}, {"metrics", {{"FID_train", Metric(2.8)}, {"accuracy", none}, {"KID", none}}}}}},
          {"paper", "a paper"},
          {"published",
           {{{"method", "Ours"},
             {"paper", "a paper"},
             {"dataset", "HumanAct12"},
             {"metric", "FID_train"},
             {"value", 2.458},
             {"pm", 0.079},
             {"pm_kind", "a2m_1.96_sd_over_sqrt_n"},
             {"table", "1"},
             {"source", "a paper, Table 1"}}}},
          {"notes", {"Three seeds."}}};
}

TEST(ResultTable, HasAColumnPerMetricAndThePublishedRowsBelow) {
  const Table table = ResultTable(Result(), "toy");
  ASSERT_EQ(table.columns.size(), 2u);
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[0].name, "Real");
  EXPECT_FALSE(table.rows[1].cells[1].value);
  EXPECT_EQ(table.rows[2].source, "a paper, Table 1");
  EXPECT_NEAR((*table.rows[2].cells[0].interval)[1], 2.537, 1e-12);
  EXPECT_EQ(table.notes, std::vector<std::string>{"Three seeds."});
}

TEST(ResultTable, MarksValuesOutsideThePublishedIntervalOnOriginalDataOnly) {
  nlohmann::json result = Result();
  EXPECT_FALSE(ResultTable(result, "toy").rows[1].cells[0].marked);
  result["original_data"] = true;
  EXPECT_TRUE(ResultTable(result, "toy").rows[1].cells[0].marked);
  result["rows"][1]["metrics"]["FID_train"]["value"] = 2.5;
  EXPECT_FALSE(ResultTable(result, "toy").rows[1].cells[0].marked);
  result["published"][0]["rounding"] = 0.0005;
  result["rows"][1]["metrics"]["FID_train"]["value"] = 2.5374;  // 2.458 + 0.079 as printed may be 2.538
  EXPECT_FALSE(ResultTable(result, "toy").rows[1].cells[0].marked);
  result["published"].push_back(result["published"][0]);
  result["published"][1]["value"] = 9.0;  // the same figure as another table prints it
  EXPECT_FALSE(ResultTable(result, "toy").rows[1].cells[0].marked);
}

TEST(Published, NumbersOfADataSetStartWithItsOwnPaper) {
  const char* csv =
      "paper,table,dataset,method,metric,value,pm,pm_kind,source\n"
      "ACTOR,3,NTU-13,ACTOR (ours),accuracy,0.971,2e-05,actor_1.96_variance,\"Petrovich et al., Table 3\"\n"
      "Action2Motion,1,NTU-13,Ours,FID_train,0.33,,a2m_1.96_sd_over_sqrt_n,x\n";
  const auto list = PublishedOf(csv, "t.csv", "Action2Motion", "NTU-13");
  ASSERT_TRUE(list) << list.error().Message();
  ASSERT_EQ(list->size(), 2u);
  EXPECT_EQ((*list)[0]["method"], "Ours");
  EXPECT_TRUE((*list)[0]["pm"].is_null());
  EXPECT_EQ((*list)[1]["source"], "Petrovich et al., Table 3");
  EXPECT_EQ(PublishedOf(csv, "t.csv", "ACTOR", "CMU")->size(), 0u);
  const auto broken = PublishedOf("header\nACTOR,3,NTU-13,x,FID,many,,,\n", "t.csv", "ACTOR", "CMU");
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().where, "t.csv:2");
}

}  // namespace
}  // namespace mocurate
