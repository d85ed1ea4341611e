// Options of a source declaration are applied, or rejected with their name.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/formats/npy.h"
#include "ingest/inspect/inspect.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Not;

std::vector<std::string> CodesOf(const std::vector<Finding>& findings) {
  std::vector<std::string> codes;
  for (const Finding& finding : findings) codes.push_back(finding.code);
  return codes;
}

/// The columns of the take in another order; -1: a column of zeros.
NpyArray Columns(const NpyArray& take, const std::vector<int>& from) {
  NpyArray array = take;
  array.shape = {take.shape[0], from.size(), 3};
  array.values.assign(array.shape[0] * from.size() * 3, 0.0);
  for (std::size_t f = 0; f < take.shape[0]; ++f) {
    for (std::size_t j = 0; j < from.size(); ++j) {
      if (from[j] < 0) continue;
      std::copy_n(&take.values[(f * take.shape[1] + static_cast<std::size_t>(from[j])) * 3], 3,
                  &array.values[(f * from.size() + j) * 3]);
    }
  }
  return array;
}

TEST_F(RecordedSets, ArrayJointsMayBeReorderedAndSkipped) {
  NpyArray take = *ParseNpy(*ReadFile(TestData() + "/humanact12/humanml3d_sample/012314_joints.npy"), "a");
  take.dtype = "<f8";
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  IngestOptions options = SmallArrays(FreshFolder("array_order"));
  std::vector<int> from;
  for (int j = static_cast<int>(take.shape[1]) - 1; j >= 0; --j) from.push_back(j);
  std::rotate(from.begin(), from.begin() + 5, from.end());
  for (const bool passed_over : {false, true}) {
    if (passed_over) from.insert(from.begin() + 3, -1);
    options.source.joints.clear();
    for (const int j : from) options.source.joints.push_back(j < 0 ? "-" : skeleton->joints[j].name);
    Put(options.path / "take.npy", WriteNpy(Columns(take, from)));
    const auto discovery = Discover(options);
    ASSERT_TRUE(discovery) << discovery.error().Message();
    const Ingested ingested = RunIngest(discovery->items.at(0), "array_order");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_THAT(CodesOf(ingested.outcome->findings), Not(Contains("joint_order_contradiction"))) << passed_over;
    const Inspection inspection = InspectPath(options.path, options.source);
    EXPECT_THAT(CodesOf(inspection.findings), Not(Contains("joint_order_contradiction")));
    ASSERT_EQ(inspection.clips.size(), 1u);
    EXPECT_EQ(inspection.clips[0].joint_names.at(4), skeleton->joints[4].name);
    const Vector3d knee(take.values[12], take.values[13], take.values[14]);
    EXPECT_LT((*inspection.clips[0].first_frame.value->at(4) - knee).norm(), 1e-3) << "each name keeps its position";
  }
}

TEST(DeclaredOptions, RequireLieParametersOfAllJoints) {
  IngestOptions options = SmallArrays(FreshFolder("lie_joints"));
  options.source.skeleton = "humanact12";
  const SkeletonPtr skeleton = *LoadSkeleton("humanact12");
  options.source.lie_bone_lengths.assign(skeleton->joints.size(), 0.2);
  options.source.joints = {skeleton->joints[0].name, skeleton->joints[1].name};
  NpyArray array;
  array.dtype = "<f8";
  array.shape = {5, 2, 3};
  array.values.assign(30, 0.1);
  Put(options.path / "take.npy", WriteNpy(array));
  ExpectError(IngestOnly(options, "lie_joints"), ErrorCode::kConfig, "ingest.source.joints");
}

TEST(DeclaredOptions, DropSkippedTableColumns) {
  IngestOptions options = SmallTable(FreshFolder("table_passed_over"));
  options.source.joints = {"left_hip", "-", "right_hip"};
  options.source.columns = {"x", "y", "z", "confidence"};
  Put(options.path / "a1_s1.txt", "10 20 30 0.5\n1e9 7 7 0.1\n40 50 60 1\n11 21 31 0.5\n1e9 7 7 0.1\n41 51 61 1\n");
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "table_passed_over");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const JointTracks& tracks = *ingested.clip.evidence.tracks;
  EXPECT_THAT(tracks.names, ElementsAre("left_hip", "right_hip"));
  EXPECT_THAT(tracks.confidence, ElementsAre(0.5, 1.0, 0.5, 1.0));
  EXPECT_TRUE(tracks.positions.at(1, 1).isApprox(Vector3d(0.041, 0.051, 0.061), 1e-6));
}

TEST(DeclaredOptions, RejectOptionsThatTheFormatIgnores) {
  IngestOptions ntu = Declared("ntu");
  ntu.source.depth_files = "{frame}.png";
  ExpectError(CheckSource(ntu.source), ErrorCode::kConfig, "ingest.source.depth_files");
  IngestOptions uestc = Declared("uestc");
  uestc.source.known_issue_lists = {"ntu_reported"};
  ExpectError(CheckSource(uestc.source), ErrorCode::kConfig, "ingest.source.known_issue_lists");
}

TEST(DeclaredOptions, ReportAnUnknownSkeletonOrUnitInTheInspection) {
  IngestOptions options = SmallTable(FreshFolder("no_skeleton"));
  Put(options.path / "a1_s1.txt", "10 20 30\n40 50 60\n");
  SourceOptions source = options.source;
  source.skeleton = "bogus";
  EXPECT_THAT(CodesOf(InspectPath(options.path, source).findings), Contains("unknown_skeleton"));
  source = options.source;
  source.units = "furlong";
  EXPECT_THAT(CodesOf(InspectPath(options.path, source).findings), Contains("units_unknown"));
}

TEST(DeclaredOptions, AcceptASingleFileByRelativePath) {
  const IngestOptions options = SmallTable(FreshFolder("relative_path"));
  Put(options.path / "a1_s1.txt", "10 20 30\n40 50 60\n");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(options.path);
  const Inspection inspection = InspectPath("a1_s1.txt", options.source);
  std::filesystem::current_path(before);
  EXPECT_EQ(inspection.clips.size(), 1u);
}

TEST(DeclaredOptions, RejectActionsThatACheckDoesNotSupport) {
  const auto read = [](const std::string& text) -> Expected<CheckOptions> {
    const auto node = LoadConfig(ConfigSource{text, "checks.yaml", {}}, {});
    return node ? OptionsFromConfig<CheckOptions>(*node) : Forward(node);
  };
  EXPECT_TRUE(read("repeated_value: {action: missing}\nposition_jump: {action: drop}\nduplicate: {action: drop}\n"));
  for (const char* text : {"motionless_clip:\n  action: missing\n", "near_duplicate:\n  action: missing\n"}) {
    ExpectError(read(text), ErrorCode::kConfig, "checks.yaml:2:11");
  }
}

TEST(DeclaredOptions, ShowTextsInAnyEncoding) {
  IngestOptions options;
  options.path = FreshFolder("latin1");
  const std::string channels = " CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  Put(options.path / "x_walk.bvh",
      "HIERARCHY\nROOT World\n{\n OFFSET 0 0 0\n" + channels +
          " JOINT H\xFC"
          "fte\n {\n OFFSET 9 9 9\n" +
          channels +
          " JOINT LeftUpLeg\n {\n OFFSET 10 0 0\n CHANNELS 3 Zrotation Xrotation Yrotation\n"
          " }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.02\n"
          "0 0 0 0 0 0 1 80 3 10 20 30 0 0 0\n0 0 0 0 0 0 2 81 5 10 20 40 0 0 0\n");
  options.source.name = "small";
  options.source.format = "bvh";
  options.source.files = "{person}_{action}.bvh";
  options.source.units = "cm";
  options.source.axes = "+x +y +z";
  const Inspection inspection = InspectPath(options.path, options.source);
  ASSERT_EQ(inspection.clips.size(), 1u);
  EXPECT_EQ(inspection.clips[0].Fact("translation_from"),
            "H\xFC"
            "fte");
  EXPECT_FALSE(InspectionText(inspection).empty());
}

}  // namespace
}  // namespace mocurate
