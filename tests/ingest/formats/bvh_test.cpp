#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
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

/// Largest distance in metres between the ingested joints and the kinematics of the file, from its joint `first` on;
/// joints of the file that the skeleton lacks are skipped.
double BvhJointError(const Motion& motion, const Bvh& bvh, const Matrix3d& metres_from_file, std::size_t first = 0) {
  double worst = 0.0;
  std::vector<Vector3d> positions;
  for (int f = 0; f < bvh.frames; ++f) {
    BvhForward(bvh, f, positions);
    for (std::size_t j = first; j < positions.size(); ++j) {
      const std::optional<int> joint = motion.skeleton->FindJoint(bvh.joints[j].name);
      if (joint) worst = std::max(worst, (motion.joints.at(f, *joint) - metres_from_file * positions[j]).norm());
    }
  }
  return worst;
}

std::vector<std::string> CodesOf(const Outcome& outcome) {
  std::vector<std::string> codes;
  for (const Finding& finding : outcome.findings) codes.push_back(finding.code);
  return codes;
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

TEST(BvhSource, ReadsThePersonBelowARootThatNeverMoves) {
  const std::string rows = kStill + "1 80 3 10 20 30  10 0 0 5 6 7  -10 0 0 1 2 3\n" + kStill +
                           "2 81 5 10 20 40  10 0 0 5 6 7  -10 0 0 1 2 3\n";
  const IngestOptions options = SmallSource("hips", rows);
  Outcome outcome;
  const Motion motion = Only(options, "hips", &outcome);
  EXPECT_EQ(motion.rate, (FrameRate{50, 1}));
  ASSERT_EQ(motion.joint_count(), 3);
  EXPECT_EQ(motion.skeleton->joints[0].name, "Hips");
  EXPECT_TRUE(motion.root_translation[0].isApprox(Vector3d(0.01, 0.80, 0.03), 1e-6));
  EXPECT_LT(BvhJointError(motion, *ParseBvh(SmallBvh(rows), "x"), 0.01 * Matrix3d::Identity()), 1e-6);
  EXPECT_NEAR(motion.bone_length[1], 0.10, 1e-7);
  EXPECT_EQ(motion.skeleton->joints[1].mirror, 2);
  ASSERT_EQ(CodesOf(outcome), std::vector<std::string>{"scene_root"});
  EXPECT_EQ(outcome.findings[0].joint, "World");
  EXPECT_EQ(outcome.findings[0].action, FindingAction::kExcluded);
  EXPECT_NEAR(outcome.findings[0].value, Vector3d(0.02, 0.81, 0.05).norm(), 1e-6);
  EXPECT_EQ(outcome.kind, OutcomeKind::kDone);
}

/// A tree World, Mid, Hips, Head whose first two joints have these channels, and rows of its numbers.
IngestOptions ScenesSource(const std::string& name, const std::string& world, const std::string& middle,
                           const std::string& rows) {
  IngestOptions options = SmallSource(name, "");
  const std::string hips = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  Put(options.path / "x_walk.bvh",
      "HIERARCHY\nROOT World\n{\nOFFSET 3 4 5\n" + world + "JOINT Mid\n{\nOFFSET 0 30 0\n" + middle +
          "JOINT Hips\n{\nOFFSET 0 60 0\n" + hips +
          "JOINT Head\n{\nOFFSET 0 50 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n}\n}\n}\n}\nMOTION\nFrames: 2\n"
          "Frame Time: 0.02\n" +
          rows);
  return options;
}

Bvh FileOf(const IngestOptions& options) { return *ParseBvh(*ReadFile(options.path / "x_walk.bvh"), "x"); }

TEST(BvhSource, KeepsEveryJointWhereTheFileHasItWhateverChannelsItsRootHas) {
  const std::string turning = "CHANNELS 3 Zrotation Xrotation Yrotation\n";
  const std::string moving = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  const Matrix3d metres = 0.01 * Matrix3d::Identity();
  struct Case {
    const char* name;
    std::string world, middle, rows;
    const char* root;  ///< of the motion
    int joints;
  };
  const std::vector<Case> cases = {
      // The hips walk below a root without channels, a turned one, and one that moves as well.
      {"none", "CHANNELS 0\n", "CHANNELS 0\n", "0 93 0 1 2 3 4 5 6\n370 93 0 1 2 30 4 5 6\n", "Hips", 2},
      {"turned", turning, turning, "10 20 30 1 2 3 0 93 0 1 2 3 4 5 6\n10 25 30 1 2 9 370 93 0 1 2 30 4 5 6\n", "Hips",
       2},
      {"both", moving, turning, "0 0 0 0 9 0 1 2 3 0 93 0 1 2 3 4 5 6\n90 0 0 0 9 5 1 2 3 7 91 0 1 2 30 4 5 6\n",
       "Hips", 2},
      // The middle joint moves, the hips are a bone.
      {"middle", "CHANNELS 0\n", moving, "0 33 0 5 6 7 0 60 0 1 2 3 4 5 6\n200 33 1 5 6 9 0 60 0 1 2 30 4 5 6\n", "Mid",
       3},
      // Nothing below the root moves: it stays, as do its OFFSETs.
      {"rigid", "CHANNELS 0\n", "CHANNELS 0\n", "0 60 0 1 2 3 4 5 6\n0 60 0 1 2 30 4 5 6\n", "World", 4},
      {"walks", moving, turning, "0 9 0 0 9 0 1 2 3 0 60 0 1 2 3 4 5 6\n370 9 0 0 9 5 1 2 3 0 60 0 1 2 30 4 5 6\n",
       "World", 4},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.name);
    const IngestOptions options = ScenesSource("scene", one.world, one.middle, one.rows);
    Outcome outcome;
    const Motion motion = Only(options, "scene", &outcome);
    ASSERT_EQ(motion.joint_count(), one.joints);
    EXPECT_EQ(motion.skeleton->joints[0].name, one.root);
    const Bvh bvh = FileOf(options);
    EXPECT_LT(BvhJointError(motion, bvh, metres), 1e-6);
    const bool whole = one.joints == 4;
    const std::vector<std::string> codes = CodesOf(outcome);  // two frames far apart jump
    EXPECT_EQ(std::count(codes.begin(), codes.end(), "scene_root"), whole ? 0 : 1);
    EXPECT_EQ(std::count(codes.begin(), codes.end(), "root_moved"), 0);
    std::vector<Vector3d> places;
    std::vector<Matrix3d> global;
    for (int f = 0; f < 2; ++f) {
      BvhForward(bvh, f, places, &global);
      const std::size_t root = 4 - static_cast<std::size_t>(one.joints);
      EXPECT_LT((motion.root_translation[f] - metres * places[root]).norm(), 1e-6);
      EXPECT_LT((motion.rotation_at(f, 0).toRotationMatrix() - global[root]).norm(), 1e-6);
    }
  }
}

TEST(BvhSource, ReportsARootThatTheDeclaredSkeletonPutsElsewhere) {
  IngestOptions options =
      ScenesSource("declared", "CHANNELS 0\n", "CHANNELS 0\n", "0 93 0 0 0 0 0 0 0\n370 93 0 0 0 0 0 0 0\n");
  const auto declare = [&](const std::string& hips) {
    Put(options.path / "four.yaml",
        "name: four\njoints:\n  - {name: World}\n  - {name: Mid, parent: World, rest_offset: [0, 0.3, 0]}\n"
        "  - {name: Hips, parent: Mid, rest_offset: " +
            hips + "}\n  - {name: Head, parent: Hips, rest_offset: [0, 0.5, 0]}\n");
    options.source.skeleton = (options.path / "four.yaml").string();
    options.source.other_files = OtherFiles::kIgnore;
    Outcome outcome;
    const Motion motion = Only(options, "declared", &outcome);
    EXPECT_EQ(motion.joint_count(), 4);
    EXPECT_LT(BvhJointError(motion, FileOf(options), 0.01 * Matrix3d::Identity(), 2), 1e-6) << "from the hips on";
    return outcome;
  };
  const Outcome outcome = declare("[0, 0.6, 0]");
  ASSERT_FALSE(outcome.findings.empty());
  ASSERT_EQ(outcome.findings[0].code, "root_moved");
  EXPECT_EQ(outcome.findings[0].joint, "World");
  EXPECT_EQ(outcome.findings[0].severity, Severity::kWarning);
  // The hips lie 0.9 m above the root in the skeleton, in the file 0.3 m (Mid) and the channels above it.
  EXPECT_NEAR(outcome.findings[0].value, Vector3d(3.7, 0.33, 0.0).norm(), 1e-6);
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
  const int leg = *motion.skeleton->FindJoint("LeftUpLeg");
  EXPECT_TRUE(motion.skeleton->joints[leg].rest_offset.isApprox(Vector3d(0.12, 0.01, 0), 1e-6));
}

TEST(BvhSource, FlagsOrRefusesASlidingBone) {
  const auto rows = [](const std::string& slide) {
    return kStill + "1 80 3 0 0 0  10 0 0 0 0 0  -10 0 0 0 0 0\n" + kStill + "9 80 3 0 0 0  " + slide +
           " 0 0 0 0 0  -10 0 0 0 0 0\n";
  };
  Outcome outcome;
  Only(SmallSource("slides", rows("10.1")), "slides", &outcome);
  ASSERT_EQ(CodesOf(outcome), (std::vector<std::string>{"bone_slides", "scene_root"}));
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
    // bandai22 puts joint_Root on the hips.
    worst = std::max(worst, BvhJointError(motion, *ParseBvh(*bytes, "x"), 0.01 * Matrix3d::Identity(), 1));
  }
  EXPECT_EQ(frames, 18913);
  EXPECT_LT(worst, 1e-6);
  RecordProperty("worst_joint_error_nm", static_cast<int>(worst * 1e9));
}

TEST(BvhSource, KeepsBandaisJointsInATreeOfTheirOwn) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  for (const std::string set : {"bandai1", "bandai2"}) {
    IngestOptions options = Declared(set);
    options.source.skeleton = "";
    const auto discovery = Discover(options);
    ASSERT_TRUE(discovery) << discovery.error().Message();
    double worst = 0.0, nearest = 100.0;
    for (std::size_t i = 0; i < discovery->items.size(); i += 12) {
      const Ingested ingested = RunIngest(discovery->items[i], "own_tree");
      ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
      const Motion& motion = *ingested.clip.motion;
      EXPECT_EQ(motion.skeleton->joints[0].name, "Hips");
      const Bvh bvh = *ParseBvh(*ReadFile(discovery->items[i].inputs[0].path), "x");
      worst = std::max(worst, BvhJointError(motion, bvh, 0.01 * Matrix3d::Identity()));
      ASSERT_EQ(ingested.outcome->findings.size(), 1u);
      EXPECT_EQ(ingested.outcome->findings[0].code, "scene_root");
      nearest = std::min(nearest, ingested.outcome->findings[0].value);
    }
    EXPECT_LT(worst, 1e-6);
    EXPECT_GT(nearest, 0.8) << "the hips are that far above the root, which stays on the floor";
  }
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
