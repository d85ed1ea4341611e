// Acclaim skeletons and motions with one defect.

#include <regex>

#include "core/formats/amc.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

class DamagedAcclaim : public ChangedFiles {
 protected:
  void Write(const std::string& motion) {
    Written("01.asf", Recorded("cmu/asf_amc/01.asf"));
    Written("01_01.amc", motion);
  }
  static std::string Motion() { return std::regex_replace(Recorded("cmu/asf_amc/01_01.amc"), std::regex("\r"), ""); }
  /// Replaces the row of a bone in a frame.
  static std::string WithRow(std::string text, int frame, const std::string& bone, const std::string& row) {
    const std::size_t at = text.find("\n" + bone + " ", text.find("\n" + std::to_string(frame) + "\n")) + 1;
    return text.replace(at, text.find('\n', at) + 1 - at, row);
  }
};

TEST_F(DamagedAcclaim, ReportsOnlyTheWrongUnitOfAHeader) {
  std::string text = Motion();
  Write(text.replace(text.find(":DEGREES"), 8, ":RADIANS"));
  const Json inspection = Inspect();
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("angle_unit_contradiction"));
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
  for (const char* field : {"up", "handedness", "rate_hz"})
    EXPECT_EQ(inspection.at("clips")[0].at(field).at("from"), "unknown") << "no estimate from invalid poses";
  const StageOutcome clip = RunOne(From("cmu_amc"));
  EXPECT_THAT(ErrorCodes(clip), ElementsAre("angle_unit_contradiction"));
  EXPECT_EQ(clip.findings.size(), 1u);
}

TEST_F(DamagedAcclaim, KeepsCompleteFramesOfATruncatedMotion) {
  const std::string text = Motion();
  Write(text.substr(0, text.find("\nrradius", text.find("\n500\n")) + 5));
  const Json inspection = Inspect();
  EXPECT_THAT(Places(inspection), ElementsAre("cut_off 01_01.amc"));
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
  const Json finding = FindingsOf(inspection, "cut_off").at(0);
  EXPECT_EQ(finding.at("value"), 20) << "bones of frame 500";
  EXPECT_THAT(finding.at("message"), HasSubstr("14975")) << "the line of that frame";
  EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), 499);
  const StageOutcome clip = RunOne(From("cmu_amc"));
  EXPECT_THAT(ErrorCodes(clip), ElementsAre("cut_off"));
  EXPECT_EQ(clip.summary.at("frames"), 499);
}

TEST_F(DamagedAcclaim, InterpolatesAFrameWithAMissingRow) {
  Write(Motion());
  const auto whole = Discover(From("cmu_amc"));
  const Ingested before = RunIngest(whole->items.at(0), "whole");
  ASSERT_TRUE(before.outcome);
  for (const char* bone : {"rfemur", "root"}) {
    for (const char* row : {"", "thigh 1 2 3\n"}) {
      Write(WithRow(Motion(), 300, bone, row));
      const Ingested after = RunIngest(Discover(From("cmu_amc"))->items.at(0), "missing");
      ASSERT_TRUE(after.outcome) << after.outcome.error().Message();
      ASSERT_FALSE(after.outcome->findings.empty());
      const Finding& finding = after.outcome->findings[0];
      EXPECT_EQ(finding.code, *row == '\0' ? "bone_missing" : "bone_unknown");
      EXPECT_EQ(finding.action, FindingAction::kInterpolated);
      EXPECT_EQ(finding.frame_begin, 299);
      const int joints = before.clip.motion->joint_count();
      for (int f = 290; f < 310; ++f) {
        for (int j = 0; j < joints; ++j)
          EXPECT_LT((after.clip.motion->joints.at(f, j) - before.clip.motion->joints.at(f, j)).norm(), 0.01) << f;
      }
      EXPECT_THAT(Codes(Inspect(), "warning"), Contains(finding.code));
    }
  }
}

TEST_F(DamagedAcclaim, RecognisesAMotionWithoutItsHeader) {
  const std::string text = Motion();
  Write(text.substr(text.find("\n1\n") + 1));
  const Json inspection = Inspect();
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  EXPECT_EQ(inspection.at("clips")[0].at("format"), "amc");
}

TEST_F(DamagedAcclaim, ReportsADamagedSkeletonFileOnce) {
  Write(Motion());
  const std::string skeleton = Recorded("cmu/asf_amc/01.asf");
  Written("01.asf", skeleton.substr(0, skeleton.size() / 2));
  Written("01_02.amc", Motion());
  const Json inspection = Inspect();
  int count = 0;
  for (const Json& finding : inspection.at("findings")) {
    count += finding.at("where").get<std::string>().rfind("01.asf", 0) == 0 ? 1 : 0;
  }
  EXPECT_EQ(count, 1) << inspection.at("findings").dump(1);
}

TEST_F(DamagedAcclaim, ReportsADamagedFrameNumberOrRowOnce) {
  const std::string text = Motion();
  const std::size_t number = text.find("\n12\n") + 1;
  ASSERT_NE(number, 0u);
  for (const std::string damage : {"1x2\n", "1.2\n", ""}) {
    Write(std::string(text).replace(number, 3, damage));
    const Json inspection = Inspect();
    ASSERT_EQ(inspection.at("findings").size(), 1u) << damage << inspection.at("findings").dump(1);
    EXPECT_EQ(inspection.at("findings")[0].at("code"), "frame_number") << damage;
    EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), 2751);
  }
  Write(WithRow(text, 12, "lfemur", "lfemur 1.0\n"));
  const Json findings = Inspect().at("findings");
  ASSERT_EQ(findings.size(), 1u) << findings.dump(1);
  EXPECT_EQ(findings[0].at("code"), "row_length");
}

}  // namespace
}  // namespace mocurate
