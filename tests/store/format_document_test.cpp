#include <gtest/gtest.h>

#include <cstdlib>

#include "core/base/file.h"
#include "core/store/store.h"
#include "core/store/table.h"
#include "tests/store/builders.h"

namespace mocurate {
namespace {

const std::filesystem::path kDocument = std::filesystem::path(MOCURATE_SOURCE_FOLDER) / "docs" / "store_format.md";

TEST(StoreFormat, StoreFormatMdMatchesTheTable) {
  const std::string document = StoreFormatDocument();
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    const Status made = WriteFile(kDocument, document);
    ASSERT_TRUE(made) << made.error().Message();
  }
  const auto written = ReadFile(kDocument);
  ASSERT_TRUE(written) << written.error().Message();
  EXPECT_TRUE(*written == document) << "run MOCURATE_REGENERATE=1 test_store --gtest_filter='StoreFormat*'";
}

TEST(StoreFormat, EveryFieldIsInTheDocument) {
  const std::string document = StoreFormatDocument();
  for (const store::Schema* schema : store::AllSchemas()) {
    EXPECT_NE(document.find("## " + schema->name + "\n"), std::string::npos);
    for (const store::Field& field : schema->fields) {
      const std::string path = field.path.rfind("/@", 0) == 0 ? field.path.substr(1) : field.path;
      EXPECT_NE(document.find("| `" + path + "` |"), std::string::npos) << field.path;
      EXPECT_FALSE(field.meaning.empty()) << field.path;
    }
  }
}

}  // namespace
}  // namespace mocurate
