// Findings on AMASS files and BABEL labels that contradict themselves, in a run and in an inspection.

#include <gmock/gmock.h>

#include "core/formats/amass.h"
#include "core/formats/babel.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kLabels = "amass/babel_v1.0_release/train.json";
constexpr const char* kMotion = "amass/STUDIO/p01/01_01_poses.npz";

class AmassFindings : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options = Perfect(StudioLayout::kAmass);
    options.subjects = 1;
    Write(options);
  }

  void Put(const std::string& name, const std::string& bytes) { ASSERT_TRUE(WriteFile(folder / name, bytes)); }

  /// Edits the first motion.
  void Change(const std::function<void(Amass&)>& change) {
    Amass amass = *ParseAmass(Bytes(kMotion), "motion.npz");
    change(amass);
    Put(kMotion, *EncodeAmass(amass, "motion.npz"));
  }

  void ChangeLabels(const std::function<void(BabelSequence&)>& change) {
    std::vector<BabelSequence> sequences = *ParseBabel(Bytes(kLabels), "train.json");
    change(sequences.at(0));
    key_ = sequences.at(0).key;
    Put(kLabels, EncodeBabel(sequences));
  }

  std::vector<Json> Inspected(const std::string& code) const {
    return FindingsOf(InspectPath(folder / "amass", std::nullopt), code);
  }

  /// "begin-end severity" of the findings of a code.
  std::vector<std::string> InRun(const std::string& code) const {
    std::vector<std::string> spans;
    for (const ItemResult& clip : RunAll(Declared("amass", {"ingest.path=" + (folder / "amass").string()}))) {
      for (const Finding& finding : clip.outcome.findings) {
        if (finding.code != code) continue;
        spans.push_back(std::to_string(finding.frame_begin) + "-" + std::to_string(finding.frame_end) + " " +
                        std::string(Name(finding.severity)));
      }
    }
    return spans;
  }

  std::string key_;
};

TEST_F(AmassFindings, ReportRepeatedOrZeroPosesWhileTheRootMoves) {
  EXPECT_THAT(Inspected("frozen_pose"), IsEmpty());
  EXPECT_THAT(InRun("frozen_pose"), IsEmpty());
  Change([](Amass& amass) {
    const auto wide = static_cast<std::ptrdiff_t>(amass.pose_columns);
    for (std::ptrdiff_t f = 101; f < 140; ++f)
      std::copy_n(amass.poses.begin() + 100 * wide, wide, amass.poses.begin() + f * wide);
  });
  std::vector<Json> findings = Inspected("frozen_pose");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("value"), 40);
  EXPECT_EQ(findings[0].at("severity"), "warning");
  EXPECT_THAT(InRun("frozen_pose"), ElementsAre("100-140 warning"));
  Change([](Amass& amass) { std::fill(amass.poses.begin(), amass.poses.end(), 0.0); });
  findings = Inspected("frozen_pose");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("severity"), "error");
}

TEST_F(AmassFindings, ReportZeroPosesWhenTheRootIsZeroToo) {
  Change([](Amass& amass) {
    const auto wide = static_cast<std::ptrdiff_t>(amass.pose_columns);
    std::fill_n(amass.poses.begin() + 100 * wide, 5 * wide, 0.0);
    std::fill_n(amass.poses.begin() + 140 * wide, wide, 0.0);
    std::fill_n(amass.translation_m.begin() + 300, 15, 0.0);
  });
  const std::vector<Json> findings = Inspected("frozen_pose");
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].at("value"), 5);
  EXPECT_EQ(findings[1].at("value"), 1);
  EXPECT_THAT(InRun("frozen_pose"), ElementsAre("100-105 warning", "140-141 warning"));
}

TEST_F(AmassFindings, ReportABodyWithoutARootPath) {
  EXPECT_THAT(Inspected("path_missing"), IsEmpty());
  Change([](Amass& amass) { std::fill(amass.translation_m.begin(), amass.translation_m.end(), 0.0); });
  const std::vector<Json> findings = Inspected("path_missing");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("severity"), "warning");
  EXPECT_THAT(Inspected("zero_joint"), IsEmpty()) << "covered by path_missing";
  EXPECT_EQ(InRun("path_missing").size(), 1u);
}

TEST_F(AmassFindings, ReportRepeatedWholeFramesAsFrozenFramesOnly) {
  Change([](Amass& amass) {
    const auto wide = static_cast<std::ptrdiff_t>(amass.pose_columns);
    for (std::ptrdiff_t f = 101; f < 140; ++f) {
      std::copy_n(amass.poses.begin() + 100 * wide, wide, amass.poses.begin() + f * wide);
      std::copy_n(amass.translation_m.begin() + 300, 3, amass.translation_m.begin() + 3 * f);
    }
  });
  EXPECT_THAT(Inspected("frozen_pose"), IsEmpty());
  EXPECT_EQ(Inspected("frozen_frames").size(), 1u);
}

TEST_F(AmassFindings, ReportAnAnnotationOfAnotherDurationWithFileAndSequence) {
  EXPECT_THAT(Inspected("annotation_duration"), IsEmpty());
  ChangeLabels([](BabelSequence& sequence) { sequence.dur *= 2.0; });
  const std::vector<Json> findings = Inspected("annotation_duration");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("where"), "babel_v1.0_release/train.json:" + key_);
  EXPECT_EQ(InRun("annotation_duration").size(), 1u);
}

TEST_F(AmassFindings, ReportAMissingMotionFileAndCountMissingSubsets) {
  EXPECT_THAT(Inspected("motion_missing"), IsEmpty());
  ChangeLabels([](BabelSequence& sequence) { sequence.feat_p = "STUDIO/STUDIO/p01/01_07_poses.npz"; });
  std::vector<Json> findings = Inspected("motion_missing");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("severity"), "warning");
  EXPECT_EQ(findings[0].at("where"), "babel_v1.0_release/train.json:" + key_);
  EXPECT_THAT(findings[0].at("message"), HasSubstr("STUDIO/STUDIO/p01/01_07_poses.npz"));
  ChangeLabels([](BabelSequence& sequence) { sequence.feat_p = "KIT/KIT/3/jump_poses.npz"; });
  findings = Inspected("motion_missing");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("severity"), "info");
  EXPECT_EQ(findings[0].at("value"), 1);
}

TEST_F(AmassFindings, DoNotReportAnUnreadableMotionAsMissing) {
  Put(kMotion, "PK\x03\x04 cut off");
  EXPECT_THAT(Inspected("motion_missing"), IsEmpty());
  EXPECT_EQ(Inspected("malformed").size(), 1u);
}

TEST_F(AmassFindings, ReportAnUnknownBabelCategoryWithItsSequence) {
  EXPECT_THAT(Inspected("category_unknown"), IsEmpty());
  ChangeLabels([](BabelSequence& sequence) {
    sequence.frame_anns.at(0).labels.at(0).act_cat = {"walkk"};
    sequence.frame_anns.at(0).labels.at(1).act_cat = {"flying on a carpet"};
  });
  const std::vector<Json> findings = Inspected("category_unknown");
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_THAT(findings[0].at("message"), AllOf(HasSubstr(key_), HasSubstr("'walkk'"), HasSubstr("'walk'")));
  EXPECT_THAT(findings[1].at("message"), HasSubstr("'flying on a carpet'"));
}

}  // namespace
}  // namespace mocurate
