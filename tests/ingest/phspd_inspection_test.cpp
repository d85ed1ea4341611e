// Recordings of PHSPD, as an inspection and a run see them.

#include <gmock/gmock.h>

#include "core/base/text.h"
#include "core/formats/phspd_text.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST_F(PhspdInspection, IsOfSmplInMetresAndWhatLiesBesideItIsKnown) {
  const std::vector<ItemResult> clips = RunAll(options_);
  for (const Json& inspection : Inspections()) {
    EXPECT_EQ(inspection.at("format"), "phspd_pose");
    ASSERT_EQ(inspection.at("clips").size(), clips.size());
    for (std::size_t i = 0; i < clips.size(); ++i) {
      EXPECT_EQ(Value(inspection.at("clips")[i], "frames"), clips[i].outcome.summary.at("frames"));
      EXPECT_EQ(Value(inspection.at("clips")[i], "skeleton"), "smpl24");
      EXPECT_EQ(inspection.at("clips")[i].at("units").at("from"), "declared");
    }
    EXPECT_THAT(Codes(inspection, "error"), IsEmpty());
    EXPECT_THAT(Codes(inspection, "info"), testing::Not(Contains("other_files")));
  }
}

TEST_F(PhspdInspection, MillimetresContradictTheFormatInBoth) {
  PhspdPose pose = *ParsePhspdPose(*ReadFile(pose_), "pose.txt");
  for (double& value : pose.position_m) value *= 1000.0;
  ASSERT_TRUE(WriteFile(pose_, WritePhspdPose(pose)));
  EXPECT_EQ(CountCode(RunAll(options_), "units_contradiction"), 1u);
  for (const Json& inspection : Inspections())
    EXPECT_THAT(Codes(inspection, "error"), ElementsAre("units_contradiction"));
}

TEST_F(PhspdInspection, AFrameThatComesTwiceIsNamedByItsLine) {
  std::vector<std::string> lines = Lines();
  lines.insert(lines.begin() + 6, lines[5]);
  Put(lines);
  for (const Json& inspection : Inspections()) {
    ASSERT_THAT(Codes(inspection, "error"), ElementsAre("malformed"));
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("severity") != "error") continue;
      EXPECT_THAT(finding.at("where").get<std::string>(), HasSubstr(":7"));
    }
  }
}

TEST_F(PhspdInspection, ANumberThatIsNoneIsToldWithItsLineAndJoint) {
  std::vector<std::string> lines = Lines();
  const std::size_t third = lines[5].find(' ', lines[5].find(' ') + 1) + 1;
  lines[5].replace(third, lines[5].find(' ', third) - third, "nan");
  Put(lines);
  for (const Json& inspection : Inspections()) {
    std::vector<std::string> told;
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("code") == "not_a_number") told.push_back(finding.at("message"));
    }
    EXPECT_THAT(told, ElementsAre(HasSubstr(":6: 'nan' is not a finite number (column 3, 'position of joint 0, y')")));
  }
}

}  // namespace
}  // namespace mocurate
