// Recordings of PHSPD in an inspection and in a run.

#include <gmock/gmock.h>

#include "core/base/text.h"
#include "core/formats/phspd_text.h"
#include "tests/ingest/changed_files.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class PhspdInspection : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options = Perfect(StudioLayout::kPhspd);
    options.subjects = 1;
    options.depth.enabled = false;
    Write(options);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "phspd/pose")) {
      if (entry.path().filename() == "pose.txt" && (pose_.empty() || entry.path() < pose_)) pose_ = entry.path();
    }
    options_ = Declared("phspd", {"ingest.path=" + (folder / "phspd").string()});
  }

  /// Lines of the first recording.
  std::vector<std::string> Lines() const {
    const std::string text = *ReadFile(pose_);
    std::vector<std::string> lines;
    for (const std::string_view line : SplitText(text, '\n')) {
      if (!line.empty()) lines.emplace_back(line);
    }
    return lines;
  }

  void Put(const std::vector<std::string>& lines) const {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    ASSERT_TRUE(WriteFile(pose_, text));
  }

  /// With the source declared, and without.
  std::vector<Json> Inspections() const {
    return {InspectPath(folder / "phspd/pose", options_.source), InspectPath(folder / "phspd/pose", std::nullopt)};
  }

  std::filesystem::path pose_;
  IngestOptions options_;
};

TEST_F(PhspdInspection, ReportsSmplInMetresAndCompanionFiles) {
  const std::vector<ItemResult> clips = RunAll(options_);
  for (const Json& inspection : Inspections()) {
    EXPECT_EQ(inspection.at("format"), "phspd_pose");
    ASSERT_EQ(inspection.at("clips").size(), clips.size());
    for (std::size_t i = 0; i < clips.size(); ++i) {
      EXPECT_EQ(Value(inspection.at("clips")[i], "frames"), clips[i].summary.at("frames"));
      EXPECT_EQ(Value(inspection.at("clips")[i], "skeleton"), "smpl24");
      EXPECT_EQ(inspection.at("clips")[i].at("units").at("from"), "declared");
    }
    EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
    EXPECT_THAT(Codes(inspection, "info"), testing::Not(Contains("other_files")));
  }
}

TEST_F(PhspdInspection, ReportsMillimetresInRunAndInspect) {
  PhspdPose pose = *ParsePhspdPose(*ReadFile(pose_), "pose.txt");
  for (double& value : pose.position_m) value *= 1000.0;
  ASSERT_TRUE(WriteFile(pose_, WritePhspdPose(pose)));
  EXPECT_EQ(CountCode(RunAll(options_), "units_contradiction"), 1u);
  for (const Json& inspection : Inspections())
    EXPECT_THAT(Codes(inspection, "error"), ElementsAre("units_contradiction"));
}

TEST_F(PhspdInspection, ReportsTheLineOfARepeatedFrame) {
  std::vector<std::string> lines = Lines();
  lines.insert(lines.begin() + 6, lines[5]);
  Put(lines);
  for (const Json& inspection : Inspections())
    EXPECT_THAT(Places(inspection), ElementsAre("malformed subject01_group1_time1/pose.txt:7"));
}

TEST_F(PhspdInspection, ReportsADistantRootAsAPositionJump) {
  PhspdPose pose = *ParsePhspdPose(*ReadFile(pose_), "pose.txt");
  ASSERT_GT(pose.frame.size(), 40u);
  const int far = pose.frame[20] - pose.frame[0];
  for (std::size_t row = 20; row < 25; ++row) {
    for (std::size_t i = 0; i < 3 * kPhspdJoints; i += 3) pose.position_m[row * 3 * kPhspdJoints + i] += 1000.0;
  }
  ASSERT_TRUE(WriteFile(pose_, WritePhspdPose(pose)));
  std::vector<Finding> findings;
  for (const ItemResult& clip : RunAll(options_)) {
    for (const Finding& finding : FindingsOf(clip.outcome, "position_jump")) findings.push_back(finding);
  }
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].frame_begin, far);
  const std::vector<Json> inspected = FindingsOf(Inspections()[0], "position_jump");
  ASSERT_EQ(inspected.size(), 1u);
  EXPECT_THAT(inspected[0].at("where"), HasSubstr(" frames " + std::to_string(far) + "-"));
}

TEST_F(PhspdInspection, ReportsAPoseInAFolderOfAnotherName) {
  const auto whole = Discover(options_);
  ASSERT_TRUE(whole) << whole.error().Message();
  EXPECT_TRUE(whole->excluded.empty()) << whole->excluded.front().item;
  EXPECT_TRUE(whole->findings.empty()) << whole->findings.front().message;
  std::filesystem::rename(pose_.parent_path(), folder / "phspd/pose/other_name");
  const auto renamed = Discover(options_);
  ASSERT_TRUE(renamed) << renamed.error().Message();
  ASSERT_EQ(renamed->findings.size(), 1u);
  EXPECT_EQ(renamed->findings[0].code, "name_mismatch");
  EXPECT_THAT(renamed->findings[0].message, HasSubstr("pose/other_name/pose.txt"));
}

TEST_F(PhspdInspection, ReportsLineAndJointOfAnInvalidNumber) {
  std::vector<std::string> lines = Lines();
  const std::size_t third = lines[5].find(' ', lines[5].find(' ') + 1) + 1;
  lines[5].replace(third, lines[5].find(' ', third) - third, "nan");
  Put(lines);
  for (const Json& inspection : Inspections()) {
    const std::vector<Json> findings = FindingsOf(inspection, "not_a_number");
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_THAT(findings[0].at("where").get<std::string>(), StartsWith("subject01_group1_time1/pose.txt"));
    EXPECT_THAT(findings[0].at("message"), AllOf(HasSubstr(":6:"), HasSubstr("joint 0, y")));
  }
}

}  // namespace
}  // namespace mocurate
