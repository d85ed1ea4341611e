#include "ingest/inspect/inspect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "ingest/synthetic/studio.h"
#include "tests/ingest/inspections.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path DataFolder() {
  const char* folder = std::getenv("MOCURATE_DATA");
  return folder == nullptr ? fs::path() : fs::path(folder);
}

#define NEEDS_DATA() \
  if (DataFolder().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set"

/// Counts of clips, of clips with a reported field, and of correct reports.
struct Score {
  int clips = 0, reported = 0, right = 0;
};
Score ScoreOf(const Json& inspection, const char* field, const Json& expected) {
  Score score;
  for (const Json& clip : inspection.at("clips")) {
    ++score.clips;
    if (Value(clip, field).is_null()) continue;
    ++score.reported;
    if (Value(clip, field) == expected) ++score.right;
  }
  return score;
}

void ExpectReported(const Json& inspection, const char* field, const Json& expected, double reported, double right) {
  const Score score = ScoreOf(inspection, field, expected);
  std::printf("  %-24s %-10s reported %d of %d, right %d\n",
              inspection.at("path").get<std::string>().substr(0, 40).c_str(), field, score.reported, score.clips,
              score.right);
  EXPECT_GE(score.reported, reported * score.clips) << field;
  EXPECT_GE(score.right, right * score.reported) << field;
}

/// Without image and depth files.
Json WithoutScreens(Json inspection) {
  Json kept = Json::array();
  for (const Json& clip : inspection.at("clips")) {
    if (clip.at("file").get<std::string>().rfind("screen/", 0) != 0) kept.push_back(clip);
  }
  inspection["clips"] = std::move(kept);
  return inspection;
}

class InspectedFiles : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  fs::path Written(const std::string& name, const std::string& bytes) {
    EXPECT_TRUE(WriteFile(folder_ / name, bytes));
    return folder_ / name;
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_ / "inspection";
};

SourceOptions KardSource() {
  SourceOptions source;
  source.name = "kard";
  source.format = "joint_table";
  source.files = "a{action}_s{person}_e{repetition}_realworld.txt";
  source.units = "mm";
  source.axes = "+x +y -z";
  source.rate_hz = 30.0;
  source.skeleton = "openni15";
  source.rows_per_frame = 15;
  source.joints = {"head",          "neck",       "right_shoulder", "right_elbow", "right_hand",
                   "left_shoulder", "left_elbow", "left_hand",      "torso",       "right_hip",
                   "right_knee",    "right_foot", "left_hip",       "left_knee",   "left_foot"};
  return source;
}

TEST_F(InspectedFiles, RecogniseAKardFileWithoutADeclaration) {
  NEEDS_DATA();
  const Json inspection = InspectPath(DataFolder() / "kinect/kard/a17_s01_e01_realworld.txt", std::nullopt);
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[0];
  EXPECT_EQ(inspection.at("format"), "joint_table");
  EXPECT_EQ(Value(clip, "joints"), 15);
  EXPECT_EQ(Value(clip, "skeleton"), "openni15");
  EXPECT_EQ(clip.at("first_frame").at("value")[0].at("joint"), "head");
  EXPECT_EQ(clip.at("first_frame").at("value")[2].at("joint"), "right_shoulder");
  EXPECT_EQ(Value(clip, "units"), "mm");
  EXPECT_EQ(Value(clip, "up"), "+y");
  EXPECT_EQ(Value(clip, "handedness"), "left");
  EXPECT_EQ(clip.at("handedness").at("from"), "measured");
  EXPECT_EQ(Value(clip, "axes"), "+x +y -z");
  EXPECT_THAT(Codes(inspection, "error"), ::testing::IsEmpty());
}

TEST_F(InspectedFiles, RecogniseAllKardFiles) {
  NEEDS_DATA();
  const Json inspection = WithoutScreens(InspectPath(DataFolder() / "kinect/kard", std::nullopt));
  ExpectReported(inspection, "units", "mm", 1.0, 0.99);
  ExpectReported(inspection, "up", "+y", 0.99, 1.0);
  ExpectReported(inspection, "joints", 15, 0.99, 0.98);
  ExpectReported(inspection, "handedness", "left", 0.2, 0.97);
}

TEST_F(InspectedFiles, RecogniseOtherKinectSets) {
  NEEDS_DATA();
  struct Set {
    const char* folder;
    int joints;
    const char* units;
  };
  for (const Set& set : {Set{"kinect/florence3d", 15, "mm"}, Set{"kinect/utkinect", 20, "m"},
                         Set{"kinect/msr_action3d", 20, "m"}, Set{"kinect/cad60", 15, "mm"}}) {
    SCOPED_TRACE(set.folder);
    const Json inspection = WithoutScreens(InspectPath(DataFolder() / set.folder, std::nullopt));
    ExpectReported(inspection, "joints", set.joints, 0.9, 0.95);
    ExpectReported(inspection, "units", set.units, 0.9, 0.97);
    ExpectReported(inspection, "up", "+y", 0.9, 0.97);
    ExpectReported(inspection, "handedness", "right", 0.2, 0.9);
  }
}

TEST_F(InspectedFiles, SkipAJointOrderThatPutsTheHeadBelowTheTrunk) {
  NEEDS_DATA();
  const Json inspection = InspectPath(DataFolder() / "kinect/utkinect/pickUp_s04_e01.txt", std::nullopt);
  const Json& clip = inspection.at("clips").at(0);
  EXPECT_THAT(clip.at("skeleton").at("evidence").get<std::string>(), ::testing::HasSubstr("'kinect1'"));
  EXPECT_LT(clip.at("skeleton").at("confidence"), 0.2) << "the person bends and tracking is poor";
  EXPECT_EQ(Value(clip, "units"), "m");
  EXPECT_EQ(Value(clip, "up"), "+y");
  EXPECT_EQ(Value(clip, "handedness"), "right");
}

TEST_F(InspectedFiles, ReportBandaiFilesRightHandedInCentimetres) {
  NEEDS_DATA();
  const Json inspection = InspectPath(DataFolder() / "bvh/bandai2", std::nullopt);
  EXPECT_EQ(inspection.at("clips").size(), 120u);
  EXPECT_EQ(inspection.at("format"), "bvh");
  ExpectReported(inspection, "units", "cm", 1.0, 1.0);
  ExpectReported(inspection, "up", "+y", 1.0, 1.0);
  ExpectReported(inspection, "handedness", "right", 0.9, 1.0);
  ExpectReported(inspection, "skeleton", "bandai22", 1.0, 1.0);
  ExpectReported(inspection, "rate_hz", 30.0, 1.0, 1.0);
  EXPECT_THAT(Codes(inspection, "error"), ::testing::IsEmpty());
}

TEST_F(InspectedFiles, EstimateTheUnitOfTenBvhExporters) {
  NEEDS_DATA();
  const Json inspection = InspectPath(DataFolder() / "bvh/misc", std::nullopt);
  std::map<std::string, Json> clips;
  for (const Json& clip : inspection.at("clips")) clips[clip.at("id")] = clip;
  for (const auto& [id, clip] : clips) {
    std::printf("  %-42s units %s up %s handedness %s\n", id.c_str(), Value(clip, "units").dump().c_str(),
                Value(clip, "up").dump().c_str(), Value(clip, "handedness").dump().c_str());
    if (id == "nlarion_mediapipe_walking.bvh") continue;  // from video: y points down
    EXPECT_NE(Value(clip, "handedness"), "left") << id;
    EXPECT_TRUE(Value(clip, "up").is_null() || Value(clip, "up") == "+y") << id;
  }
  EXPECT_EQ(Value(clips.at("omimo_AV_8Walk_HVHA.bvh"), "units"), "inch");
  EXPECT_EQ(Value(clips.at("olafhaag_walk01.bvh"), "units"), "cm");
  EXPECT_EQ(Value(clips.at("dme_xia_angry_13.bvh"), "units"), "2.2222222222222 inch");
  EXPECT_TRUE(Value(clips.at("fairmotion_sinusoidal.bvh"), "handedness").is_null());
}

TEST_F(InspectedFiles, ReportGeneratedPositionsYDownAndRejectRotations) {
  NEEDS_DATA();
  const fs::path generated = DataFolder() / "humanact12/a2m_generated";
  const Json positions = InspectPath(generated / "humanact12_tf/motion_joints500000.npy", std::nullopt);
  ASSERT_EQ(positions.at("clips").size(), 20u);
  ExpectReported(positions, "up", "-y", 0.9, 1.0);
  ExpectReported(positions, "units", "m", 0.9, 1.0);
  ExpectReported(positions, "handedness", "right", 0.4, 0.9);
  const Json rotations = InspectPath(generated / "humanact12_lie/motion_joints30000.npy", std::nullopt);
  EXPECT_THAT(Codes(rotations, "error"), ::testing::Contains("not_joint_positions"));
}

TEST_F(InspectedFiles, ReadADepthSequenceAsOneClip) {
  NEEDS_DATA();
  const Json inspection = InspectPath(DataFolder() / "clouds/rendered_seq", std::nullopt);
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  const Json& clip = inspection.at("clips")[0];
  EXPECT_EQ(clip.at("format"), "depth_sequence");
  EXPECT_EQ(Value(clip, "frames"), 48);
  EXPECT_EQ(Value(clip, "rate_hz"), 12.0);
  EXPECT_EQ(Value(clip, "up"), "-y");
  EXPECT_EQ(clip.at("up").at("from"), "declared");
}

TEST_F(InspectedFiles, ContradictAWrongDeclaration) {
  NEEDS_DATA();
  const fs::path file = DataFolder() / "kinect/kard/a17_s01_e01_realworld.txt";
  EXPECT_THAT(Codes(InspectPath(file, KardSource()), "error"), ::testing::IsEmpty());
  SourceOptions wrong = KardSource();
  wrong.axes = "+x +y +z";
  EXPECT_THAT(Codes(InspectPath(file, wrong), "error"), ::testing::ElementsAre("handedness_contradiction"));
  wrong = KardSource();
  wrong.units = "cm";
  EXPECT_THAT(Codes(InspectPath(file, wrong), "error"), ::testing::ElementsAre("units_contradiction"));
  wrong = KardSource();
  wrong.axes = "+x +z +y";
  EXPECT_THAT(Codes(InspectPath(file, wrong), "error"), ::testing::Contains("up_contradiction"));
  wrong = KardSource();
  std::swap(wrong.joints[0], wrong.joints[11]);
  std::swap(wrong.joints[3], wrong.joints[13]);
  EXPECT_THAT(Codes(InspectPath(file, wrong), "error"), ::testing::Contains("joint_order_contradiction"));
}

TEST_F(InspectedFiles, NameTheJointsThatDifferFromTheDeclaredSkeleton) {
  NEEDS_DATA();
  SourceOptions source;
  source.name = "bandai2";
  source.format = "bvh";
  source.files = "{clip}.bvh";
  source.units = "cm";
  source.axes = "+x +y +z";
  source.skeleton = "bandai22";
  const auto contradictions = [&](const fs::path& path) {
    return FindingsOf(InspectPath(path, source), "joints_contradiction");
  };
  EXPECT_THAT(contradictions(DataFolder() / "bvh/bandai2/dataset-2_walk_normal_001.bvh"), ::testing::IsEmpty());
  EXPECT_EQ(contradictions(DataFolder() / "bvh/misc/olafhaag_walk01.bvh").size(), 1u);
  EXPECT_EQ(contradictions(DataFolder() / "bvh/misc").size(), 7u) << "in the other files a joint slides along its bone";
}

TEST_F(InspectedFiles, RecogniseStudioFilesAsDeclared) {
  SyntheticOptions options;
  options.actions = {"squat", "kick"};
  options.subjects = 2;
  options.repetitions = 1;
  const auto files = CaptureFiles(options);
  ASSERT_TRUE(files);
  for (const auto& [name, text] : *files) Written(name, text);
  const Json inspection = InspectPath(folder_, StudioSource());
  EXPECT_EQ(inspection.at("clips").size(), 4u);
  EXPECT_THAT(Codes(inspection, "error"), ::testing::IsEmpty());
  EXPECT_EQ(inspection.at("clips")[0].at("item"), "studio/p01/kick_p01_r01");
  for (const Json& clip : inspection.at("clips")) {
    EXPECT_EQ(clip.at("up").at("measured").at("value"), "+y");
    EXPECT_EQ(clip.at("handedness").at("measured").at("value"), "left");
    EXPECT_EQ(clip.at("units").at("measured").at("value"), "mm");
    EXPECT_NEAR(Value(clip, "missing_share").get<double>(), options.tracker.dropout_share, 0.03);
  }
}

TEST_F(InspectedFiles, ReportAnErrorAndNoClipsForUnreadableFiles) {
  const Json empty = InspectPath(Written("empty.txt", ""), std::nullopt);
  EXPECT_TRUE(empty.at("clips").empty());
  EXPECT_THAT(Codes(empty, "error"), ::testing::ElementsAre("empty_file"));
  std::string junk;
  for (int i = 0; i < 5000; ++i) junk += static_cast<char>((i * 7919 + i / 3) % 256);
  const Json binary = InspectPath(Written("junk.bin", junk), std::nullopt);
  EXPECT_TRUE(binary.at("clips").empty());
  EXPECT_THAT(Codes(binary, "error"), ::testing::ElementsAre("unknown_format"));
  const Json cut = InspectPath(Written("cut.bvh", "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0"), std::nullopt);
  EXPECT_TRUE(cut.at("clips").empty());
  EXPECT_THAT(Codes(cut, "error"), ::testing::ElementsAre("malformed"));
  const Json nothing = InspectPath(folder_ / "missing", std::nullopt);
  EXPECT_THAT(Codes(nothing, "error"), ::testing::ElementsAre("not_found"));
}

TEST_F(InspectedFiles, RejectNumbersWithoutABody) {
  std::string table;
  for (int i = 0; i < 301; ++i) table += std::to_string(i * 37 % 101) + " " + std::to_string(i * 53 % 97) + "\n";
  const Json inspection = InspectPath(Written("table.txt", table), std::nullopt);
  EXPECT_TRUE(inspection.at("clips").empty());
  EXPECT_THAT(Codes(inspection, "error"), ::testing::ElementsAre("no_motion"));
}

TEST_F(InspectedFiles, PrintTheContentsOfTheJson) {
  NEEDS_DATA();
  const Inspection one = InspectPath(DataFolder() / "kinect/kard/a17_s01_e01_realworld.txt", std::nullopt);
  EXPECT_THAT(InspectionText(one), ::testing::HasSubstr("handedness  left  measured"));
  EXPECT_THAT(InspectionText(InspectPath(DataFolder() / "bvh/misc", std::nullopt)), ::testing::HasSubstr("bvh"));
}

}  // namespace
}  // namespace mocurate
