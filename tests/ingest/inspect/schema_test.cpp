// The output of `mocurate inspect --json` is valid under docs/inspect.schema.json.

#include <gmock/gmock.h>

#include "tests/ingest/inspections.h"
#include "tests/ingest/schema_check.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(InspectSchema, AcceptsReportsOnUnreadableEmptyAndMissingFiles) {
  SchemaCheck schema;
  const std::filesystem::path folder = FreshFolder("schema");
  Put(folder / "cut.bvh", "HIERARCHY\nROOT hips\n{\nOFFSET 0 0");
  Put(folder / "empty.txt", "");
  Put(folder / "truncated.json", "{\"people\": [");
  for (const std::filesystem::path& path :
       {folder, folder / "cut.bvh", folder / "truncated.json", folder / "none.bvh"}) {
    const Json inspection = InspectPath(path, std::nullopt);
    EXPECT_FALSE(inspection.at("findings").empty()) << path;
    EXPECT_THAT(schema.Faults(inspection), IsEmpty()) << path;
  }
}

TEST(InspectSchema, RejectsWhatItDoesNotDeclare) {
  SchemaCheck schema;
  Json inspection = InspectPath(FreshFolder("schema_nothing"), std::nullopt);
  ASSERT_THAT(schema.Faults(inspection), IsEmpty());
  inspection["clips"].push_back({{"id", 3}});
  inspection["findings"].push_back(
      {{"code", "a b"}, {"severity", "fatal"}, {"where", ""}, {"value", 0}, {"message", ""}, {"more", 1}});
  const std::vector<std::string> faults = schema.Faults(inspection);
  for (const char* fault :
       {"/clips/0/id: 3 is no", "/clips/0: has no \"frames\"", "/code: \"a b\" is not as the pattern",
        "/severity: \"fatal\" is not one of the enum", "/more: is not in the schema"}) {
    EXPECT_THAT(faults, Contains(HasSubstr(fault)));
  }
}

}  // namespace
}  // namespace mocurate
