#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "ingest/inspect/inspect.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

/// The result of ingesting a whole source.
struct Whole {
  int clips = 0, frames = 0, suspect = 0, refused = 0;
  std::set<std::string> people, labels;
  std::map<std::string, Ingested> by_item;
};

Whole IngestAll(const std::string& source) {
  Whole whole;
  const SourceRun& run = RunOnce(Declared(source));
  if (!run.discovery) {
    ADD_FAILURE() << run.discovery.error().Message();
    return whole;
  }
  for (std::size_t i = 0; i < run.outcomes.size(); ++i) {
    Ingested ingested = IngestedOf(run.outcomes[i], run.Artifact(i));
    whole.clips += 1;
    if (!ingested.outcome) {
      whole.refused += 1;
    } else {
      whole.suspect += ingested.outcome->kind == OutcomeKind::kSuspect ? 1 : 0;
      whole.frames += ingested.clip.evidence.tracks->positions.frames;
      whole.people.insert(ingested.clip.identity.person);
      whole.labels.insert(ingested.clip.label);
    }
    whole.by_item.emplace(run.discovery->items[i].item, std::move(ingested));
  }
  return whole;
}

/// Position of a named joint in a frame.
Vector3d At(const JointTracks& tracks, const std::string& name, int frame) {
  for (std::size_t k = 0; k < tracks.names.size(); ++k) {
    if (tracks.names[k] == name) return tracks.positions.at(frame, static_cast<int>(k));
  }
  ADD_FAILURE() << "no joint " << name;
  return Vector3d::Zero();
}

class KinectTables : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

TEST_F(KinectTables, ExcludeTheMsrAction3dClipsThatItsPapersExclude) {
  const auto discovery = Discover(Declared("msr_action3d"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  int excluded = 0;
  for (const ItemResult& file : discovery->excluded) {
    excluded +=
        file.outcome.kind == OutcomeKind::kExcluded && file.outcome.findings.at(0).code == "known_issue" ? 1 : 0;
  }
  EXPECT_EQ(excluded, 9) << "one of the ten is of person 10, absent from this folder";
  const Whole whole = IngestAll("msr_action3d");
  EXPECT_EQ(whole.clips, 440);
  EXPECT_EQ(whole.refused, 2) << "the person is missing in most frames (mostly_missing)";
  EXPECT_EQ(whole.suspect, 0);
  EXPECT_EQ(whole.people.size(), 8u);
  EXPECT_EQ(whole.labels.size(), 20u);
}

TEST_F(KinectTables, ReadZeroFramesOfMsrAction3dAsMissing) {
  const auto discovery = Discover(Declared("msr_action3d"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  for (const ItemSpec& item : discovery->items) {
    if (item.item != "msr_action3d/s02/a13_s02_e02") continue;
    const Ingested ingested = RunIngest(item, "msr_zero");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    int frames = 0;
    for (const Finding& finding : ingested.outcome->findings) {
      if (finding.code == "no_joint_seen") frames += finding.frame_end - finding.frame_begin;
    }
    EXPECT_EQ(frames, 12);
    EXPECT_EQ(ingested.outcome->findings.back().code, "long_gap");
    EXPECT_DOUBLE_EQ(ingested.outcome->summary["missing_share"].get<double>(), 12.0 / 30.0)
        << "a trunk joint with confidence 0 and a position is not missing";
    return;
  }
  FAIL() << "a13_s02_e02 is not in the folder";
}

TEST_F(KinectTables, CountMissingJointsUnlessTheConfidenceIsUndeclared) {
  const std::filesystem::path data = TestData() + "/kinect";
  const auto share = [&](const std::string& file, const std::string& recipe = "") {
    const auto source = recipe.empty() ? std::nullopt : std::optional<SourceOptions>(Declared(recipe).source);
    return nlohmann::json(InspectPath(data / file, source)).at("clips").at(0).at("missing_share");
  };
  const auto msr = share("msr_action3d/a12_s04_e03_skeleton3D.txt");
  EXPECT_TRUE(msr.at("value").is_null());
  EXPECT_EQ(msr.at("from"), "unknown");
  EXPECT_EQ(share("msr_action3d/a12_s04_e03_skeleton3D.txt", "msr_action3d").at("value"), 0.0)
      << "trunk joints are tracked";
  EXPECT_EQ(share("cad60/0512165327.txt").at("value"), 0.0164);
  EXPECT_EQ(share("cad60/0512165327.txt", "cad60").at("value"), 0.0164);
  EXPECT_EQ(share("kard/a12_s04_e03_realworld.txt").at("value"), 0.0);
}

TEST_F(KinectTables, ReportAnUndeclaredConfidenceAsAnAssumption) {
  const auto assumed_shares = [](const std::string& file, const std::optional<SourceOptions>& source) {
    const nlohmann::json inspection = InspectPath(std::filesystem::path(TestData()) / "kinect" / file, source);
    std::vector<double> shares;
    for (const nlohmann::json& finding : inspection.at("findings")) {
      if (finding.at("code") == "confidence_guessed") shares.push_back(finding.at("value"));
    }
    return shares;
  };
  const std::string msr = "msr_action3d/a01_s01_e01_skeleton3D.txt";
  ASSERT_EQ(assumed_shares(msr, std::nullopt).size(), 1u);
  EXPECT_GT(assumed_shares(msr, std::nullopt)[0], 0.1) << "trunk and hips have confidence 0 although they are tracked";
  EXPECT_TRUE(assumed_shares(msr, Declared("msr_action3d").source).empty());
  EXPECT_TRUE(assumed_shares("cad60", std::nullopt).empty()) << "the layout is known";
  EXPECT_TRUE(assumed_shares("kard/a01_s01_e01_realworld.txt", std::nullopt).empty()) << "three numbers per joint";
}

TEST_F(KinectTables, ReadOneHundredSixtyUtKinectClips) {
  const Whole whole = IngestAll("utkinect");
  EXPECT_EQ(whole.clips, 160);
  EXPECT_EQ(whole.frames, 4867);
  EXPECT_EQ(whole.refused + whole.suspect, 0);
  EXPECT_EQ(whole.people.size(), 8u);
  EXPECT_EQ(whole.labels.size(), 10u);
  const Clip& clip = whole.by_item.at("utkinect/s01/carry_s01_e01").clip;
  // First row of the file: 0.400294 -0.015386 2.311127 m; x to the sensor's left becomes -x, away from it -z.
  EXPECT_TRUE(At(*clip.evidence.tracks, "hip_center", 0).isApprox(Vector3d(-0.400294, -0.015386, -2.311127), 1e-6));
  EXPECT_EQ(clip.label, "carry");
}

TEST_F(KinectTables, ReadOneHundredSeventyThreeFlorence3dClips) {
  const Whole whole = IngestAll("florence3d");
  EXPECT_EQ(whole.clips, 173);
  EXPECT_EQ(whole.frames, 3096);
  EXPECT_EQ(whole.refused, 0);
  EXPECT_EQ(whole.suspect, 0);
  EXPECT_EQ(whole.people.size(), 8u);
  EXPECT_EQ(whole.labels.size(), 9u);
  const Clip& clip = whole.by_item.at("florence3d/s1/a01_s1_id1").clip;
  const double trunk = (At(*clip.evidence.tracks, "neck", 0) - At(*clip.evidence.tracks, "torso", 0)).norm();
  EXPECT_NEAR(trunk, 0.2043, 5e-4);
}

TEST_F(KinectTables, ReadCad60WithItsLayout) {
  const Whole whole = IngestAll("cad60");
  EXPECT_EQ(whole.clips, 3);
  EXPECT_EQ(whole.frames, 900);
  EXPECT_EQ(whole.refused + whole.suspect, 0);
  const Ingested& ingested = whole.by_item.at("cad60/unknown/0512165327");
  const JointTracks& tracks = *ingested.clip.evidence.tracks;
  EXPECT_TRUE(At(tracks, "head", 0).isApprox(Vector3d(-0.0454, 0.4972, -2.2542), 1e-6));
  EXPECT_NEAR((At(tracks, "left_knee", 0) - At(tracks, "left_foot", 0)).norm(), 0.35, 0.1);
  EXPECT_NEAR(ingested.outcome->summary["missing_share"].get<double>(), 0.01637, 1e-5);
  ASSERT_EQ(tracks.rotation.size(), tracks.confidence.size());
  const auto column = std::find(tracks.names.begin(), tracks.names.end(), "left_shoulder") - tracks.names.begin();
  double angle_sum = 0.0;  // convention of the file: the upper arm is along the x axis of its frame
  int counted = 0;
  for (int f = 0; f < tracks.positions.frames; ++f) {
    const std::size_t at = static_cast<std::size_t>(f) * tracks.names.size() + static_cast<std::size_t>(column);
    if (tracks.rotation_confidence[at] == 0.0) continue;
    const Vector3d arm = (At(tracks, "left_elbow", f) - At(tracks, "left_shoulder", f)).normalized();
    angle_sum += std::acos(std::min(1.0, std::abs(arm.dot(tracks.rotation[at] * Vector3d::UnitX()))));
    ++counted;
  }
  ASSERT_GT(counted, 100);
  EXPECT_LT(angle_sum / counted, 0.1) << "radians";
  EXPECT_EQ(tracks.rotation_confidence[14], 0.0) << "the file has no rotations of the feet";
}

TEST(JointTableLayout, ReportsAnInvalidRotationMatrix) {
  const std::filesystem::path folder = FreshFolder("no_rotation");
  const std::string good = "1 0 0 0 1 0 0 0 1 1 ";
  Put(folder / "a1_s2.txt", good + "1 2 3 " + good + "4 5 6\n" + good + "1 2 3 1 0 0 0 2 0 0 0 1 1 4 5 6\n");
  IngestOptions options = SmallTable(folder);
  options.source.layout = "2*(rotation rotation_confidence x y z)";
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "no_rotation");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.evidence.tracks->rotation_confidence, (std::vector<double>{1, 1, 1, 0}));
  int count = 0;
  for (const Finding& finding : ingested.outcome->findings) {
    if (finding.code != "not_a_rotation") continue;
    ++count;
    EXPECT_EQ(finding.frame_begin, 1);
  }
  EXPECT_EQ(count, 1);
}

TEST(JointTableLayout, NamesTheOptionThatContradictsTheLayout) {
  const std::filesystem::path folder = FreshFolder("layout");
  Put(folder / "a1_s2.txt", "1 1 2 3 1 4 5 6 1\n2 1 2 3 1 4 5 6 0\nEND\n");
  IngestOptions options = SmallTable(folder);
  options.source.layout = "frame 2*(x y z confidence)";
  options.source.end_word = "END";
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "layout");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.evidence.tracks->confidence, (std::vector<double>{1, 1, 1, 0}));
  for (const char* layout : {"frame 3*(x y z)", "frame 2*(x y)"}) {
    options.source.layout = layout;
    ExpectError(IngestOnly(options, "layout"), ErrorCode::kConfig, "ingest.source.layout");
  }
  options.source.layout = "frame 2*(x y z)";
  options.source.rows_per_frame = 2;
  ExpectError(IngestOnly(options, "layout"), ErrorCode::kConfig, "ingest.source.rows_per_frame");
  options.source.columns = {"x", "y", "z", "skip"};
  ExpectError(IngestOnly(options, "layout"), ErrorCode::kConfig, "ingest.source.layout");
}

TEST(JointTableDamage, RefusesTheFileOrDropsTheFrameOfADamagedRow) {
  const std::filesystem::path folder = FreshFolder("damage");
  Put(folder / "a1_s2.txt", "1 2 3\n4 5 6\n1 2\n4 5 6\n1 2 3\n4 5 6\n");
  IngestOptions options = SmallTable(folder);
  options.source.damaged_rows = DamagedRows::kRefuse;
  ExpectMalformed(IngestOnly(options, "damage"), "a1_s2.txt:3");
  options.source.damaged_rows = SmallTable(folder).source.damaged_rows;
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "damage");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.evidence.tracks->confidence, (std::vector<double>{1, 1, 0, 0, 1, 1}));
  ASSERT_EQ(ingested.outcome->findings.size(), 1u) << "one finding per cause";
  EXPECT_EQ(ingested.outcome->findings.at(0).code, "row_length");
}

}  // namespace
}  // namespace mocurate
