// What an AMASS file and BABEL's labels beside it say that cannot be, in a run and in an inspection.

#include <gmock/gmock.h>

#include "core/formats/amass.h"
#include "core/formats/babel.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kLabels = "amass/babel_v1.0_release/train.json";
constexpr const char* kMotion = "amass/STUDIO/p01/01_01_poses.npz";

class AmassFindings : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    Write(Perfect(StudioLayout::kAmass));
  }

  void Put(const std::string& name, const std::string& bytes) { ASSERT_TRUE(WriteFile(folder / name, bytes)); }

  /// Changes the numbers of the first motion.
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
    std::vector<Json> found;
    const Json inspection = InspectPath(folder / "amass", std::nullopt);
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("code") == code) found.push_back(finding);
    }
    return found;
  }

  std::size_t InRun(const std::string& code) const {
    std::size_t count = 0;
    for (const ItemResult& clip : RunAll(Declared("amass", {"ingest.path=" + (folder / "amass").string()}))) {
      for (const Finding& finding : clip.outcome.findings) count += finding.code == code ? 1 : 0;
    }
    return count;
  }

  std::string key_;
};

TEST_F(AmassFindings, PosesThatAreHeldOrZeroWhileTheRootGoesOnAreTold) {
  EXPECT_THAT(Inspected("frozen_pose"), IsEmpty());
  EXPECT_EQ(InRun("frozen_pose"), 0u);
  Change([](Amass& amass) {
    const auto wide = static_cast<std::ptrdiff_t>(amass.pose_columns);
    for (std::ptrdiff_t f = 101; f < 140; ++f)
      std::copy_n(amass.poses.begin() + 100 * wide, wide, amass.poses.begin() + f * wide);
  });
  std::vector<Json> told = Inspected("frozen_pose");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].at("value"), 40);
  EXPECT_EQ(told[0].at("severity"), "warning");
  EXPECT_THAT(told[0].at("message"), HasSubstr("40 frames on end (100-140)"));
  EXPECT_EQ(InRun("frozen_pose"), 1u);
  Change([](Amass& amass) { std::fill(amass.poses.begin(), amass.poses.end(), 0.0); });
  told = Inspected("frozen_pose");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].at("severity"), "error");
  EXPECT_THAT(told[0].at("message"), HasSubstr("the poses are not there"));
}

TEST_F(AmassFindings, PosesOfZerosAmongOthersAreToldThoughTheRootIsZeroToo) {
  Change([](Amass& amass) {
    const auto wide = static_cast<std::ptrdiff_t>(amass.pose_columns);
    std::fill_n(amass.poses.begin() + 100 * wide, 5 * wide, 0.0);
    std::fill_n(amass.poses.begin() + 140 * wide, wide, 0.0);
    std::fill_n(amass.translation_m.begin() + 300, 15, 0.0);
  });
  const std::vector<Json> told = Inspected("frozen_pose");
  ASSERT_EQ(told.size(), 2u);
  EXPECT_THAT(told[0].at("message"), HasSubstr("all rotations of the body are 0 in 5 frames on end (100-105)"));
  EXPECT_THAT(told[1].at("message"), HasSubstr("in 1 frame on end (140-141)"));
  EXPECT_EQ(InRun("frozen_pose"), 2u);
}

TEST_F(AmassFindings, ABodyWithoutAPathIsTold) {
  EXPECT_THAT(Inspected("path_missing"), IsEmpty());
  Change([](Amass& amass) { std::fill(amass.translation_m.begin(), amass.translation_m.end(), 0.0); });
  const std::vector<Json> told = Inspected("path_missing");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].at("severity"), "warning");
  EXPECT_THAT(Inspected("zero_joint"), IsEmpty()) << "it is the same";
  EXPECT_EQ(InRun("path_missing"), 1u);
}

TEST_F(AmassFindings, WhoRepeatsAsAWholeIsFrozenAndNoPoseCarriedOn) {
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

TEST_F(AmassFindings, ADurationThatIsNotTheMotionsIsToldWithItsFileAndSequence) {
  EXPECT_THAT(Inspected("annotation_duration"), IsEmpty());
  ChangeLabels([](BabelSequence& sequence) { sequence.dur *= 2.0; });
  const std::vector<Json> told = Inspected("annotation_duration");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].at("where"), "babel_v1.0_release/train.json:" + key_);
  EXPECT_THAT(told[0].at("message"), HasSubstr("STUDIO/p01/01_01_poses.npz"));
  EXPECT_EQ(InRun("annotation_duration"), 1u);
}

TEST_F(AmassFindings, APathThatNamesNoFileOfItsFolderIsToldAndOneOfAPartThatIsNotHereIsCounted) {
  EXPECT_THAT(Inspected("motion_missing"), IsEmpty());
  ChangeLabels([](BabelSequence& sequence) { sequence.feat_p = "STUDIO/STUDIO/p01/01_07_poses.npz"; });
  std::vector<Json> told = Inspected("motion_missing");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].at("severity"), "warning");
  EXPECT_EQ(told[0].at("where"), "babel_v1.0_release/train.json:" + key_);
  EXPECT_THAT(told[0].at("message"), HasSubstr("'STUDIO/STUDIO/p01/01_07_poses.npz'"));
  ChangeLabels([](BabelSequence& sequence) { sequence.feat_p = "KIT/KIT/3/jump_poses.npz"; });
  told = Inspected("motion_missing");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].at("severity"), "info");
  EXPECT_EQ(told[0].at("value"), 1);
}

TEST_F(AmassFindings, AMotionThatCannotBeReadIsNotMissing) {
  Put(kMotion, "PK\x03\x04 cut off");
  EXPECT_THAT(Inspected("motion_missing"), IsEmpty());
  EXPECT_EQ(Inspected("malformed").size(), 1u);
}

TEST_F(AmassFindings, ACategoryThatBabelDoesNotKnowIsToldWithItsSequence) {
  EXPECT_THAT(Inspected("category_unknown"), IsEmpty());
  ChangeLabels([](BabelSequence& sequence) {
    sequence.frame_anns.at(0).labels.at(0).act_cat = {"walkk"};
    sequence.frame_anns.at(0).labels.at(1).act_cat = {"flying on a carpet"};
  });
  const std::vector<Json> told = Inspected("category_unknown");
  ASSERT_EQ(told.size(), 2u);
  EXPECT_THAT(told[0].at("message"), HasSubstr(key_ + ": category 'walkk' of 1 label"));
  EXPECT_THAT(told[0].at("message"), HasSubstr("did you mean 'walk'?"));
  EXPECT_THAT(told[1].at("message"), HasSubstr("'flying on a carpet'"));
}

}  // namespace
}  // namespace mocurate
