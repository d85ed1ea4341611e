// The table of findings: it lists every code that is reported and no other, and docs/inspect.md is generated from
// it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "ingest/checks/finding_table.h"
#include "tests/ingest/inspections.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBegin = "<!-- findings: made by test_ingest from ingest/checks/finding_table.cpp -->\n";
constexpr const char* kEnd = "<!-- end of findings -->\n";

/// Adds the words of lower-case letters and '_' within the quotes of a line, as far as a comment.
void AddQuotedWords(const std::string& line, std::set<std::string>& words) {
  bool quoted = false;
  std::string word;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (!quoted && c == '/' && line[i + 1] == '/') return;
    if (quoted && ((c >= 'a' && c <= 'z') || c == '_')) {
      word += c;
      continue;
    }
    words.insert(std::move(word));
    word.clear();
    if (quoted && c == '\\') ++i;
    if (c == '"') quoted = !quoted;
  }
}

/// The quoted words of sources below these folders, without the table and its test.
std::set<std::string> QuotedWords(const std::vector<const char*>& folders) {
  std::set<std::string> words;
  for (const char* folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(kSourceFolder) / folder)) {
      const fs::path& file = entry.path();
      if (file.stem().string().rfind("finding_table", 0) == 0) continue;
      if (file.extension() != ".cpp" && file.extension() != ".h") continue;
      std::istringstream text(ReadFile(file).value_or(""));
      for (std::string line; std::getline(text, line);) AddQuotedWords(line, words);
    }
  }
  return words;
}

/// Codes of the answers, "code:count".
std::set<std::string> CodesOfAnswers() {
  const fs::path answers = fs::path(kSourceFolder) / "tests" / "ingest" / "inspect" / "answers.txt";
  std::istringstream text(ReadFile(answers).value_or(""));
  std::set<std::string> codes;
  for (std::string line; std::getline(text, line);) {
    std::istringstream after(line.substr(line.find('|') + 1));
    for (std::string word; after >> word;) {
      if (const std::size_t colon = word.find(':'); colon != std::string::npos) codes.insert(word.substr(0, colon));
    }
  }
  return codes;
}

TEST(FindingTable, ListsEveryReportedCodeOnceAndNoOther) {
  const std::set<std::string> reported = QuotedWords({"ingest", "core/formats", "core/quality", "core/base"});
  std::set<std::string> codes;
  for (const FindingKind& kind : FindingKinds()) {
    EXPECT_TRUE(codes.insert(kind.code).second) << kind.code;
    EXPECT_EQ(reported.count(kind.code), 1u) << kind.code;
  }
  for (const std::string& code : CodesOfAnswers()) EXPECT_EQ(codes.count(code), 1u) << code;
}

TEST(FindingTable, HasNoCodeThatNoTestReports) {
  const std::set<std::string> quoted = QuotedWords({"tests/app", "tests/formats", "tests/ingest"});
  const std::set<std::string> answered = CodesOfAnswers();
  for (const FindingKind& kind : FindingKinds()) {
    EXPECT_TRUE(quoted.count(kind.code) + answered.count(kind.code) > 0)
        << kind.code << ": no recorded, synthetic or damaged file of a test has this finding";
  }
}

const char* ActionText(OnFinding action) {
  if (action == OnFinding::kDrop) return "drop";
  if (action == OnFinding::kMissing) return "missing";
  return action == OnFinding::kDropRecorded ? "drop_recorded" : "report";
}

/// The two tables of docs/inspect.md.
std::string FindingTables() {
  std::string checks =
      "| code | severity | meaning | limits, measured on | by default "
      "|\n|---|---|---|---|---|\n";
  std::string others = "| code | severity | meaning |\n|---|---|---|\n";
  for (const FindingKind& kind : FindingKinds()) {
    const std::string row = "| `" + std::string(kind.code) + "` | " + kind.severity + " | " + kind.help + " |";
    if (kind.check == Checked::kNothing) {
      others += row + "\n";
      continue;
    }
    std::string limits;
    for (const CheckLimit& limit : kind.limits) {
      const std::string unit(Name(limit.unit));
      limits += (limits.empty() ? "`" : "; `") + std::string(limit.name) + ": " + FormatDouble(limit.value) +
                (unit.empty() ? "" : " " + unit) + "` " + limit.help + ", " + limit.source;
    }
    checks += row + " " + limits + " | " + ActionText(kind.by_default) + " |\n";
  }
  return "Checks of a clip. In a source, `checks: {repeated_value: {frames: 5, action: missing}}` sets limits and the\n"
         "action: `ignore`, `report`, set the samples to `missing` (findings of frames or joints), or `drop` the "
         "clip.\n"
         "`drop_recorded` drops clips of tracks and reports given motion, which may stand still. A fit repairs tracks\n"
         "by `fitting.repair`, independently of these actions.\n\n" +
         checks + "\nAll others:\n\n" + others;
}

TEST(FindingTable, MatchesTheDocument) {
  const fs::path document = fs::path(kSourceFolder) / "docs" / "inspect.md";
  const auto text = ReadFile(document);
  ASSERT_TRUE(text) << text.error().Message();
  const std::size_t begin = text->find(kBegin), end = text->find(kEnd);
  ASSERT_TRUE(begin != std::string::npos && end != std::string::npos);
  const std::string made = text->substr(0, begin) + kBegin + FindingTables() + text->substr(end);
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    ASSERT_TRUE(WriteFile(document, made));
    return;
  }
  EXPECT_TRUE(made == *text) << "run MOCURATE_REGENERATE=1 test_ingest --gtest_filter='FindingTable*'";
}

/// Numbers of a text, as written.
std::vector<double> NumbersIn(const std::string& text) {
  static const std::regex number(R"((?:^|[^\w.])(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?))");
  std::vector<double> numbers;
  for (auto at = std::sregex_iterator(text.begin(), text.end(), number); at != std::sregex_iterator(); ++at) {
    numbers.push_back(std::stod((*at)[1]));
  }
  return numbers;
}

TEST_F(RecordedFormats, StateTheValueOfAFindingInItsMessage) {
  std::size_t stated_values = 0;
  for (const char* path : {"ntu", "cameras", "bvh", "cmu", "humanact12", "kinect/cad60", "kinect/msr_action3d",
                           "pose2sim", "amass_babel"}) {
    const nlohmann::json inspection = Inspect(path);
    for (const nlohmann::json& finding : inspection.at("findings")) {
      const double value = finding.at("value");
      if (value == 0.0) continue;  // the message states none
      ++stated_values;
      const std::string message = finding.at("message");
      const std::vector<double> numbers = NumbersIn(message);
      const bool stated = std::any_of(numbers.begin(), numbers.end(), [&](double number) {
        const double slack = 0.006 * std::abs(value) + 1e-4;
        return std::abs(number - value) <= slack || std::abs(number / 100.0 - value) <= slack;
      });
      EXPECT_TRUE(stated) << finding;
    }
  }
  EXPECT_GT(stated_values, 20u);
}

}  // namespace
}  // namespace mocurate
