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

#include "core/base/file.h"
#include "ingest/checks/finding_table.h"
#include "tests/ingest/inspections.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBegin = "<!-- findings: made by test_ingest from ingest/checks/finding_table.cpp -->\n";
constexpr const char* kEnd = "<!-- end of findings -->\n";

/// All string literals of the sources that create findings.
std::string SourcesOfFindings() {
  std::string all;
  for (const char* room : {"ingest", "core/formats", "core/quality", "core/base", "canon"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(MOCURATE_SOURCE_FOLDER) / room)) {
      const std::string name = entry.path().filename().string();
      if (name == "finding_table.cpp" || (entry.path().extension() != ".cpp" && entry.path().extension() != ".h"))
        continue;
      all += ReadFile(entry.path()).value_or("");
    }
  }
  return all;
}

TEST(FindingTable, ListsEveryReportedCodeOnce) {
  const std::string sources = SourcesOfFindings();
  std::set<std::string> codes;
  for (const FindingKind& kind : FindingKinds()) {
    EXPECT_TRUE(codes.insert(kind.code).second) << kind.code;
    EXPECT_NE(sources.find("\"" + std::string(kind.code) + "\""), std::string::npos) << kind.code;
  }
}

TEST(FindingTable, MatchesTheDocument) {
  const fs::path document = fs::path(MOCURATE_SOURCE_FOLDER) / "docs" / "inspect.md";
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
