#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/formats/bvh.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
/// Root, hips, and two legs, with position channels on every joint. Offsets in centimetres.
std::string SmallBvh(const std::string& rows) {
  const std::string channels = " CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  return "HIERARCHY\nROOT World\n{\n OFFSET 0 0 0\n" + channels + " JOINT Hips\n {\n OFFSET 9 9 9\n" + channels +
         " JOINT LeftUpLeg\n {\n OFFSET 10 0 0\n" + channels + " }\n JOINT RightUpLeg\n {\n OFFSET -10 0 0\n" +
         channels + " }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.02\n" + rows;
}

const std::string kStill = "0 0 0 0 0 0 ";

IngestOptions SmallSource(const std::string& name, const std::string& rows) {
  IngestOptions options;
  options.path = FreshFolder(name);
  Put(options.path / "x_walk.bvh", SmallBvh(rows));
  options.source.name = "small";
  options.source.format = "bvh";
  options.source.files = "{person}_{action}.bvh";
  options.source.units = "cm";
  options.source.axes = "+x +y +z";
  return options;
}

/// Largest distance in metres between the ingested joints and the kinematics of the file, without the root.
double BvhJointError(const Motion& motion, const Bvh& bvh, const Matrix3d& metres_from_file) {
  double worst = 0.0;
  std::vector<Vector3d> positions;
  for (int f = 0; f < bvh.frames; ++f) {
    BvhForward(bvh, f, positions);
    for (std::size_t j = 1; j < positions.size(); ++j) {
      const int joint = *motion.skeleton->FindJoint(bvh.joints[j].name);
      worst = std::max(worst, (motion.joints.at(f, joint) - metres_from_file * positions[j]).norm());
    }
  }
  return worst;
}

Motion Only(const IngestOptions& options, const std::string& name, Outcome* outcome = nullptr) {
  const auto discovery = Discover(options);
  if (!discovery) ADD_FAILURE() << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), name);
  if (!ingested.outcome) ADD_FAILURE() << ingested.outcome.error().Message();
  if (outcome != nullptr && ingested.outcome) *outcome = *ingested.outcome;
  if (!ingested.clip.motion) {
    ADD_FAILURE() << "no motion";
    return {};
  }
  const Status whole = ingested.clip.motion->Check();
  EXPECT_TRUE(whole) << whole.error().Message();
  return *ingested.clip.motion;
}

TEST(BvhSource, MovesTheHipTranslationIntoTheRoot) {
  const std::string rows = kStill + "1 80 3 10 20 30  10 0 0 5 6 7  -10 0 0 1 2 3\n" + kStill +
                           "2 81 5 10 20 40  10 0 0 5 6 7  -10 0 0 1 2 3\n";
  const IngestOptions options = SmallSource("hips", rows);
  const Motion motion = Only(options, "hips");
  EXPECT_EQ(motion.rate, (FrameRate{50, 1}));
  EXPECT_TRUE(motion.root_translation[0].isApprox(Vector3d(0.01, 0.80, 0.03), 1e-6));
  EXPECT_LT(BvhJointError(motion, *ParseBvh(SmallBvh(rows), "x"), 0.01 * Matrix3d::Identity()), 1e-6);
  EXPECT_NEAR(motion.bone_length[2], 0.10, 1e-7);
  EXPECT_EQ(motion.skeleton->joints[2].mirror, 3);
}

TEST(BvhSource, KeepsTheMotionInEveryAxisConvention) {
  const std::string rows = kStill + "1 80 3 10 20 30  10 0 0 5 6 7  -10 0 0 1 2 3\n" + kStill +
                           "2 81 5 10 -70 40  10 0 0 55 6 7  -10 0 0 1 2 3\n";
  for (const char* text : {"+x +z -y", "-x +y +z", "+x -y -z", "+z +x +y"}) {
    IngestOptions options = SmallSource("axes", rows);
    options.source.axes = text;
    const Motion motion = Only(options, "axes");
    const Matrix3d world_from_file = AxisConvention::Parse(text)->canonical_from_source;
    EXPECT_LT(BvhJointError(motion, *ParseBvh(SmallBvh(rows), "x"), 0.01 * world_from_file), 1e-6) << text;
  }
}

TEST(BvhSource, ReplacesTheOffsetByAConstantPositionChannel) {
  const std::string rows =
      kStill + "1 80 3 0 0 0  12 1 0 0 0 0  -10 0 0 0 0 0\n" + kStill + "2 80 3 0 0 0  12 1 0 0 0 0  -10 0 0 0 0 0\n";
  const Motion motion = Only(SmallSource("constant", rows), "constant");
  EXPECT_TRUE(motion.skeleton->joints[2].rest_offset.isApprox(Vector3d(0.12, 0.01, 0), 1e-6));
}

TEST(BvhSource, FlagsOrRefusesASlidingBone) {
  const auto rows = [](const std::string& slide) {
    return kStill + "1 80 3 0 0 0  10 0 0 0 0 0  -10 0 0 0 0 0\n" + kStill + "9 80 3 0 0 0  " + slide +
           " 0 0 0 0 0  -10 0 0 0 0 0\n";
  };
  Outcome outcome;
  Only(SmallSource("slides", rows("10.1")), "slides", &outcome);
  ASSERT_EQ(outcome.findings.size(), 1u);
  EXPECT_EQ(outcome.findings[0].code, "bone_slides");
  EXPECT_EQ(outcome.findings[0].joint, "LeftUpLeg");
  EXPECT_NEAR(outcome.findings[0].value, 0.0005, 1e-9);
  EXPECT_EQ(outcome.findings[0].action, FindingAction::kKept);
  ExpectError(IngestOnly(SmallSource("slides", rows("20")), "slides"), ErrorCode::kUnsupported, "x_walk.bvh");
}

TEST(BvhSource, ReportsARateThatContradictsTheDeclaration) {
  const std::string rows =
      kStill + "1 80 3 0 0 0  10 0 0 0 0 0  -10 0 0 0 0 0\n" + kStill + "1 80 3 0 0 0  10 0 0 0 0 0  -10 0 0 0 0 0\n";
  IngestOptions options = SmallSource("rate", rows);
  options.source.rate_hz = 60.0;
  Outcome outcome;
  EXPECT_EQ(Only(options, "rate", &outcome).rate, (FrameRate{60, 1})) << "the declared rate is used";
  ASSERT_GE(outcome.findings.size(), 1u);
  EXPECT_EQ(outcome.findings[0].code, "rate_contradiction");
  EXPECT_EQ(outcome.findings[0].value, 50.0);
  EXPECT_EQ(outcome.kind, OutcomeKind::kSuspect);
}

TEST(BvhSource, RejectsAJointThatTheSkeletonLacks) {
  IngestOptions options =
      SmallSource("unknown", kStill + kStill + kStill + kStill + "\n" + kStill + kStill + kStill + kStill);
  options.source.skeleton = "bandai22";
  ExpectError(IngestOnly(options, "unknown"), ErrorCode::kInconsistent, "x_walk.bvh");
}

TEST(BvhSource, ReadsBandai2WithinAMicrometre) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto discovery = Discover(Declared("bandai2"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 120u);
  EXPECT_EQ(discovery->items[0].item, "bandai2/active/raise-up-both-hands_active_001");
  int frames = 0, index = 0;
  double worst = 0.0;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "bandai");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.outcome->kind, OutcomeKind::kDone) << item.item;
    EXPECT_TRUE(ingested.outcome->findings.empty()) << item.item << ": " << ingested.outcome->findings[0].message;
    const Motion& motion = *ingested.clip.motion;
    frames += motion.frame_count();
    EXPECT_EQ(motion.rate, (FrameRate{30, 1}));
    EXPECT_EQ(motion.skeleton->name, "bandai22");
    EXPECT_EQ(ingested.clip.provenance.at("style"), ingested.clip.identity.person);
    if (index++ % 12 != 0) continue;
    const auto bytes = ReadFile(item.inputs[0].path);
    worst = std::max(worst, BvhJointError(motion, *ParseBvh(*bytes, "x"), 0.01 * Matrix3d::Identity()));
  }
  EXPECT_EQ(frames, 18913);
  EXPECT_LT(worst, 1e-6);
  RecordProperty("worst_joint_error_nm", static_cast<int>(worst * 1e9));
}

TEST(BvhSource, UsesOneSkeletonForStandingAndMovingPeople) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto discovery = Discover(Declared("bandai2"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const auto bytes = ReadFile(discovery->items[0].inputs[0].path);
  auto still = ParseBvh(*bytes, "x");
  ASSERT_TRUE(still) << still.error().Message();
  const std::size_t channels = still->values.size() / static_cast<std::size_t>(still->frames);
  for (std::size_t i = channels; i < still->values.size(); ++i) still->values[i] = still->values[i % channels];
  IngestOptions options = Declared("bandai2");
  options.path = FreshFolder("bandai_still");
  Put(options.path / discovery->items[0].inputs[0].name, WriteBvh(*still));
  const Ingested moving = RunIngest(discovery->items[0], "bandai_moves");
  const Ingested standing = RunIngest(Discover(options)->items.at(0), "bandai_stands");
  ASSERT_TRUE(moving.outcome && standing.outcome);
  const Skeleton& a = *moving.clip.motion->skeleton;
  const Skeleton& b = *standing.clip.motion->skeleton;
  for (int j = 0; j < a.joint_count(); ++j) {
    EXPECT_EQ(a.joints[j].rest_offset, b.joints[j].rest_offset) << a.joints[j].name;
  }
  EXPECT_LT((moving.clip.motion->joints.at(0, 5) - standing.clip.motion->joints.at(0, 5)).norm(), 1e-5);
}

TEST(BvhSource, ReadsOtherExportersOnTheirOwnSkeletons) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  IngestOptions options = SmallSource("misc", "");
  options.path = TestData() + "/bvh/misc";
  options.source.files = "{file_name}.bvh";
  options.source.label = "";
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 10u);
  std::map<std::string, std::set<std::string>> flagged;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "misc");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    const Bvh bvh = *ParseBvh(*ReadFile(item.inputs[0].path), "x");
    EXPECT_LT(BvhJointError(*ingested.clip.motion, bvh, 0.01 * Matrix3d::Identity()), 2e-6) << item.item;
    for (const Finding& finding : ingested.outcome->findings) {
      EXPECT_NE(finding.code, "handedness_contradiction") << item.item << finding.message;
      flagged[finding.code].insert(item.item);
    }
  }
  // All are declared in centimetres; these files are in inches.
  EXPECT_THAT(flagged["units_contradiction"],
              ElementsAre("small/unknown/dme_xia_angry_13", "small/unknown/kevinxie4c_sample_2frames",
                          "small/unknown/omimo_AV_8Walk_HVHA"));
  EXPECT_THAT(flagged["up_contradiction"], ElementsAre("small/unknown/nlarion_mediapipe_walking"));
}

TEST(BvhSource, FlagsAMirroredPersonOnAnUndeclaredSkeleton) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  IngestOptions options = Declared("bandai2");
  options.path = FreshFolder("bandai_mirrored");
  const auto bytes = ReadFile(TestData() + "/bvh/misc/olafhaag_walk01.bvh");
  ASSERT_TRUE(bytes);
  Put(options.path / "dataset-2_walk_any_1.bvh", *bytes);
  options.source.rate_hz.reset();
  options.source.skeleton = "";
  for (const bool mirrored : {false, true}) {
    options.source.axes = mirrored ? "-x +y +z" : "+x +y +z";
    Outcome outcome;
    Only(options, "mirrored", &outcome);
    EXPECT_EQ(outcome.kind, mirrored ? OutcomeKind::kSuspect : OutcomeKind::kDone);
    ASSERT_EQ(outcome.findings.size(), mirrored ? 1u : 0u);
    if (!mirrored) continue;
    EXPECT_EQ(outcome.findings[0].code, "handedness_contradiction");
  }
}

}  // namespace
}  // namespace mocurate
