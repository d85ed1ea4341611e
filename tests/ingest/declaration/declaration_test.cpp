// Declarations that name absent files or another format than the files have.

#include <gmock/gmock.h>

#include "ingest/formats/driver.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kDeclaredBvh =
    "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n"
    "MOTION\nFrames: 2\nFrame Time: 0.04\n0 1 0\n0 1 0.1\n";

IngestOptions TwoTables(const std::string& folder) {
  IngestOptions options = SmallTable(FreshFolder(folder));
  for (const char* name : {"a1_s1.txt", "a2_s1.txt"}) Put(options.path / name, "1 2 3\n4 5 6\n1 3 3\n4 6 6\n");
  return options;
}

TEST(Declaration, SuggestsTheNearestNameForAnUnknownExcludedRecording) {
  IngestOptions options = TwoTables("exclude");
  options.source.exclude = {{"a1_s1", "falls over"}};
  auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_THAT(discovery->findings, IsEmpty());
  EXPECT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->excluded.at(0).outcome.findings.at(0).code, "excluded");
  options.source.exclude = {{"a1_s01", "falls over"}};
  discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 2u);
  ASSERT_EQ(discovery->findings.size(), 1u);
  EXPECT_EQ(discovery->findings[0].code, "name_unmatched");
  EXPECT_EQ(discovery->findings[0].severity, Severity::kWarning);
  EXPECT_THAT(discovery->findings[0].message,
              AllOf(HasSubstr("ingest.source.exclude"), HasSubstr("'a1_s01'"), HasSubstr("'a1_s1'")));
}

TEST(Declaration, ReportsTheActualFormatOfTheFiles) {
  IngestOptions options = SmallTable(FreshFolder("bvh_as_table"));
  for (const char* name : {"a1_s1.txt", "a2_s1.txt"}) Put(options.path / name, kDeclaredBvh);
  const auto bvh = Discover(options);
  ExpectError(bvh, ErrorCode::kConfig, "ingest.source.format");
  EXPECT_THAT(bvh.error().what, AllOf(HasSubstr("joint_table"), HasSubstr("bvh"), HasSubstr("'a1_s1.txt'")));
  Put(options.path / "a2_s1.txt", "1 2 3\n4 5 6\n");
  EXPECT_TRUE(Discover(options)) << "a single file of another format fails alone";
}

TEST(Declaration, ReportsMismatchedNamesOfItsFormatWhenOtherFilesAreIgnored) {
  IngestOptions options = SmallTable(FreshFolder("passed_over"));
  options.source.format = "bvh";
  options.source.files = "walk_{person}.bvh";
  options.source.label = "walk";
  options.source.other_files = OtherFiles::kIgnore;
  for (const char* name : {"walk_1.bvh", "run_1.bvh", "notes.txt"}) Put(options.path / name, kDeclaredBvh);
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->findings.size(), 1u);
  EXPECT_EQ(discovery->findings[0].code, "name_mismatch");
  EXPECT_EQ(discovery->findings[0].value, 1.0);
  EXPECT_THAT(discovery->findings[0].message, HasSubstr("'run_1.bvh'"));
}

TEST(Declaration, ReportsThePatternWithoutMatchesAndTheFolderContents) {
  IngestOptions options = TwoTables("endings");
  options.source.files = "{action}.bvh";
  const auto discovery = Discover(options);
  ExpectError(discovery, ErrorCode::kNotFound, options.path.string());
  EXPECT_THAT(discovery.error().Message(), HasSubstr("2 .txt"));
}

TEST_F(WrittenFormats, ContradictADeclarationOfAnotherFormat) {
  SourceOptions source;
  source.name = "made";
  source.format = "npy";
  source.files = "{take}.bvh";
  source.units = "m";
  source.axes = "+x +y +z";
  source.rate_hz = 30.0;
  source.skeleton = "smpl24";
  for (int take = 10; take < 50; ++take) Written("take" + std::to_string(take) + ".bvh", kDeclaredBvh);
  EXPECT_THAT(Codes(InspectPath(folder_, source), "error"), ::testing::Contains("format_contradiction"));
  source.format = "bvh";
  source.skeleton = "";
  source.rate_hz.reset();
  const auto declared = InspectPath(folder_, source);
  EXPECT_THAT(Codes(declared, "error"), ::testing::Not(::testing::Contains("format_contradiction")));
  const std::string text = InspectionText(declared);
  EXPECT_THAT(text, HasSubstr("+y  declared\n")) << "declared values are shown without a share of agreement";
}

TEST_F(WrittenFormats, ReportTheShareOfFilesThatAgreeOnTheRate) {
  std::string fast = kDeclaredBvh;
  const std::size_t at = fast.find("Frame Time:");
  ASSERT_NE(at, std::string::npos);
  fast.replace(at, fast.find('\n', at) - at, "Frame Time: 0.0125");
  for (int take = 10; take < 50; ++take)
    Written("take" + std::to_string(take) + ".bvh", take < 30 ? kDeclaredBvh : fast);
  EXPECT_THAT(InspectionText(InspectPath(folder_, std::nullopt)), HasSubstr("declared, 50 % agree"));
}

TEST_F(WrittenFormats, DoNotContradictADeclarationThatMatchesOtherNames) {
  SourceOptions source;
  source.name = "made";
  source.format = "npy";
  source.files = "{take}.npy";
  source.units = "m";
  source.axes = "+x +y +z";
  source.rate_hz = 30.0;
  source.skeleton = "smpl24";
  Written("take.bvh", kDeclaredBvh);
  const auto inspection = InspectPath(folder_, source);
  EXPECT_THAT(Codes(inspection, "error"), ::testing::Not(::testing::Contains("format_contradiction")));
  EXPECT_THAT(Codes(inspection, "warning"), ::testing::Contains("name_mismatch"));
  source.other_files = OtherFiles::kIgnore;
  source.files = "{take}.bvh";
  EXPECT_THAT(Codes(InspectPath(folder_, source), "error"), ::testing::Contains("format_contradiction"));
}

}  // namespace
}  // namespace mocurate
