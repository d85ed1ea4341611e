// The one list of findings: what is reported is in it, what is in it can be reported, and docs/inspect.md is made of
// it.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "core/base/file.h"
#include "ingest/checks/finding_table.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBegin = "<!-- findings: made by test_ingest from ingest/checks/finding_table.cpp -->\n";
constexpr const char* kEnd = "<!-- end of findings -->\n";

/// All texts in quotes of the sources that make findings.
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

TEST(FindingTable, HasEachCodeOnceAndNoneThatIsNeverReported) {
  const std::string sources = SourcesOfFindings();
  std::set<std::string> codes;
  for (const FindingKind& kind : FindingKinds()) {
    EXPECT_TRUE(codes.insert(kind.code).second) << kind.code;
    EXPECT_NE(sources.find("\"" + std::string(kind.code) + "\""), std::string::npos) << kind.code;
  }
}

TEST(FindingTable, OfTheDocumentIsThatOfTheProgram) {
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

}  // namespace
}  // namespace mocurate
