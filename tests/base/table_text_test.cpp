// Texts that are not ours in tables.

#include "core/base/table_text.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace mocurate {
namespace {

TEST(CsvCells, AreNoFormulasAndNumbersStay) {
  const std::pair<const char*, const char*> cells[] = {{"walk", "walk"}, {"=1+1", "'=1+1"},        {"+cmd", "'+cmd"},
                                                       {"-x", "'-x"},    {"@sum", "'@sum"},        {"\t=1", "'\t=1"},
                                                       {"'=1", "''=1"},  {"'quoted'", "'quoted'"}, {"-1.5", "-1.5"},
                                                       {"+3", "+3"},     {"1e-3", "1e-3"},         {"", ""},
                                                       {"a=1", "a=1"}};
  for (const auto& [text, cell] : cells) {
    EXPECT_EQ(CsvCell(text), cell);
    EXPECT_EQ(QuotedCsvCell(text), '"' + std::string(cell) + '"');
    EXPECT_EQ(TextOfCsvCell(cell), text);
  }
  EXPECT_EQ(CsvCell("=a,\"b\"\n"), "\"'=a,\"\"b\"\"\n\"");
}

TEST(CsvCells, ComeBackFromALine) {
  const std::vector<std::string> texts = {"=a,\"b\"", "-1", "", "'=1", "c d"};
  std::string line;
  for (const std::string& text : texts) line += (line.empty() ? "" : ",") + CsvCell(text);
  EXPECT_EQ(CellsOfCsvLine(line), texts);
  EXPECT_FALSE(CellsOfCsvLine("a,\"b"));
}

TEST(MarkdownTexts, HoldNoMarkup) {
  EXPECT_EQ(MarkdownText("<script>a & b</script>"), "&lt;script>a &amp; b&lt;/script>");
  EXPECT_EQ(MarkdownText("[a](b) | ![c](d)"), "\\[a\\](b) \\| !\\[c\\](d)");
  EXPECT_EQ(MarkdownText("# a\n# b"), "\\# a # b");
  EXPECT_EQ(MarkdownText("a\n---\x1b"), "a ---\\\\x1b");
  EXPECT_EQ(MarkdownText("> - 1"), "\\> - 1");
}

}  // namespace
}  // namespace mocurate
