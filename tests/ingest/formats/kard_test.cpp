#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "ingest/inspect/comparison.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

class Kard : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

TEST_F(Kard, HasFourHundredThirtyTwoClipsOfEightPeople) {
  const auto discovery = Discover(Declared("kard"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 432u);
  ASSERT_EQ(discovery->excluded.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].item, "screen");  // image coordinates of some clips: skipped and reported
  EXPECT_EQ(discovery->items[0].item, "kard/s01/a01_s01_e01");
  EXPECT_EQ(discovery->items[0].inputs[0].name, "a01_s01_e01_realworld.txt");
  EXPECT_EQ(discovery->items[0].options.Whole().dump().find(TestData()), std::string::npos)
      << "options contain the folder";
}

TEST_F(Kard, IsReadInMetresAndRightHanded) {
  const SourceRun& run = RunOnce(Declared("kard"));
  ASSERT_TRUE(run.discovery) << run.discovery.error().Message();
  int frames = 0;
  std::set<std::string> people, labels;
  for (std::size_t i = 0; i < run.outcomes.size(); ++i) {
    const Ingested ingested = IngestedOf(run.outcomes[i], run.Artifact(i));
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.outcome->kind, OutcomeKind::kDone)
        << run.discovery->items[i].item << ": "
        << (ingested.outcome->findings.empty() ? "" : ingested.outcome->findings[0].message);
    const JointTracks& tracks = *ingested.clip.evidence.tracks;
    frames += tracks.positions.frames;
    people.insert(ingested.clip.identity.person);
    labels.insert(ingested.clip.label);
    EXPECT_EQ(ingested.outcome->summary["missing_share"], 0.0);
    const double trunk = (tracks.positions.at(0, 0) - tracks.positions.at(0, 8)).norm();
    EXPECT_GT(trunk, 0.3);
    EXPECT_LT(trunk, 0.6);
  }
  EXPECT_EQ(frames, 51228);
  EXPECT_EQ(people.size(), 8u);
  EXPECT_EQ(labels.size(), 18u);
}

/// The clip without one of its rows, read with damaged rows allowed: missing frames and finding codes.
struct Shortened {
  std::vector<int> missing;
  std::vector<std::string> codes;
  int frames = 0;
  bool read = false;
};

Shortened WithoutRow(const std::string& recording, int frame, int row) {
  const std::filesystem::path folder = FreshFolder("kard_row");
  const std::string name = recording + "_realworld.txt";
  std::ifstream from(std::filesystem::path(TestData()) / "kinect/kard" / name);
  std::ofstream to(folder / name);
  int at = 0;
  for (std::string line; std::getline(from, line); ++at) {
    if (at != 15 * frame + row) to << line << '\n';
  }
  to.close();
  IngestOptions options = Declared("kard");
  options.path = folder;
  options.source.damaged_rows = DamagedRows::kReport;
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "kard_row");
  Shortened shortened;
  if (!ingested.outcome) return shortened;
  shortened.read = true;
  for (const Finding& finding : ingested.outcome->findings) shortened.codes.push_back(finding.code);
  const auto& tracks = ingested.clip.evidence.tracks;
  if (tracks) shortened.frames = tracks->positions.frames;
  for (int f = 0; tracks && f < tracks->positions.frames; ++f) {
    if (tracks->confidence[static_cast<std::size_t>(f) * 15] == 0.0) shortened.missing.push_back(f);
  }
  return shortened;
}

TEST_F(Kard, RefusesAMissingRowAndAcceptsATruncatedEnd) {
  for (const auto& [frame, row] : {std::pair{190, 7}, {3, 0}, {100, 14}, {0, 9}}) {
    EXPECT_FALSE(WithoutRow("a14_s01_e01", frame, row).read) << frame << ", " << row;
  }
  const Shortened cut = WithoutRow("a14_s01_e01", 205, 14);  // the last row
  EXPECT_TRUE(cut.read);
  EXPECT_THAT(cut.codes, testing::Contains("cut_off"));
  EXPECT_TRUE(cut.missing.empty());
}

/// Codes of the findings in the first clip, or of its error.
std::vector<std::string> Contradictions(const std::vector<std::string>& assignments) {
  const auto discovery = Discover(Declared("kard", assignments));
  if (!discovery) return {std::string(Name(discovery.error().code))};
  const Ingested ingested = RunIngest(discovery->items[0], "kard_wrong");
  if (!ingested.outcome) return {std::string(Name(ingested.outcome.error().code))};
  std::vector<std::string> codes;
  for (const Finding& finding : ingested.outcome->findings) codes.push_back(finding.code);
  return codes;
}

TEST_F(Kard, ContradictsAWrongUnitOrUpAxis) {
  using ::testing::ElementsAre;
  EXPECT_THAT(Contradictions({}), ElementsAre());
  EXPECT_THAT(Contradictions({"ingest.source.units=cm"}), ElementsAre("units_contradiction"));
  EXPECT_THAT(Contradictions({"ingest.source.axes=+x -y +z"}), ElementsAre("up_contradiction"));
  EXPECT_THAT(Contradictions({"ingest.source.units=cm", "ingest.source.on_contradiction=refuse"}),
              ElementsAre("inconsistent"));
}

TEST_F(Kard, ReadsIdentityAndPositionsOfTheFirstClip) {
  const auto discovery = Discover(Declared("kard"));
  ASSERT_TRUE(discovery);
  const Ingested ingested = RunIngest(discovery->items[0], "kard_first");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const Clip& clip = ingested.clip;
  const JointTracks& tracks = *clip.evidence.tracks;
  EXPECT_EQ(clip.id(), "kard/s01/a01_s01_e01#0-" + std::to_string(tracks.positions.frames));
  EXPECT_EQ(clip.label, "horizontal_arm_wave");
  EXPECT_EQ(clip.rate, (FrameRate{30, 1}));
  EXPECT_EQ(tracks.names[0], "head");
  // First row of the file: 133.46135 562.2903 2687.6377 mm; z away from the sensor becomes -z.
  EXPECT_TRUE(tracks.positions.at(0, 0).isApprox(Vector3d(0.13346135, 0.5622903, -2.6876377), 1e-6));
  EXPECT_NEAR(tracks.time_s[1], 1.0 / 30.0, 1e-12);
}

TEST_F(Kard, ExtendsAContradictionOfThreeClipsToTheirSet) {
  const IngestOptions options =
      Declared("kard", {"ingest.source.axes='+x +y +z'", "ingest.source.files='a{action}_s01_e01_realworld.txt'",
                        "ingest.source.person=s01", "ingest.source.recording='{action}'"});
  std::vector<ItemResult> clips = RunAll(options);
  ASSERT_EQ(clips.size(), 18u);
  const std::size_t contradicting = CountCode(clips, "handedness_contradiction");
  EXPECT_GE(contradicting, 3u);
  EXPECT_LT(contradicting, 5u);
  const auto set_findings = FindSetContradictions(options.source, clips);
  ASSERT_EQ(set_findings.size(), 1u);
  EXPECT_EQ(set_findings[0].code, "handedness_contradiction");
  EXPECT_EQ(CountCode(clips, "handedness_contradiction"), clips.size());
}

TEST_F(Kard, FlagsAWrongHandednessWithoutMirroringTheClip) {
  const auto honest = Discover(Declared("kard"));
  const auto discovery = Discover(Declared("kard", {"ingest.source.axes='+x +y +z'"}));
  ASSERT_TRUE(honest && discovery);
  int flagged = 0, sitting = 0, sitting_flagged = 0;
  for (const ItemSpec& item : discovery->items) {
    const bool sits = item.item.find("/a17") != std::string::npos || item.item.find("/a18") != std::string::npos;
    const Ingested ingested = RunIngest(item, "kard_left");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    const bool found = ingested.outcome->kind == OutcomeKind::kSuspect;
    flagged += found ? 1 : 0;
    sitting += sits ? 1 : 0;
    sitting_flagged += sits && found ? 1 : 0;
    if (!found) continue;
    const Finding& finding = ingested.outcome->findings.at(0);
    EXPECT_EQ(finding.code, "handedness_contradiction");
    EXPECT_EQ(finding.severity, Severity::kError);
    EXPECT_EQ(finding.action, FindingAction::kFlagged);
    EXPECT_EQ(finding.clip, ingested.clip.id());
    EXPECT_GT(ingested.clip.evidence.tracks->positions.at(0, 0).z(), 1.0) << "the clip was mirrored";
  }
  RecordProperty("flagged", flagged);
  EXPECT_EQ(sitting, 48);
  EXPECT_EQ(sitting_flagged, 45) << "in three clips the hands swing behind the trunk";
  EXPECT_EQ(flagged, 105) << "the other clips show too little, or only the hands";
}

TEST_F(Kard, RefusesAContradictoryClipOnRequest) {
  const auto discovery =
      Discover(Declared("kard", {"ingest.source.axes='+x +y +z'", "ingest.source.on_contradiction=refuse"}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  for (const ItemSpec& item : discovery->items) {
    if (item.item != "kard/s01/a17_s01_e01") continue;
    const Ingested ingested = RunIngest(item, "kard_refused");
    ExpectError(ingested.outcome, ErrorCode::kInconsistent, "a17_s01_e01_realworld.txt");
    EXPECT_FALSE(std::filesystem::exists(ingested.artifact));
  }
}

TEST_F(Kard, KeepsItemsAndBytesWhenTheFolderMoves) {
  const std::filesystem::path moved = FreshFolder("moved kard \xFF");
  const std::string file = "a05_s03_e02_realworld.txt";
  std::filesystem::copy_file(TestData() + "/kinect/kard/" + file, moved / file);
  IngestOptions options = Declared("kard");
  const auto here = Discover(options);
  options.path = moved;
  const auto there = Discover(options);
  ASSERT_TRUE(here && there);
  ASSERT_EQ(there->items.size(), 1u);
  for (const ItemSpec& item : here->items) {
    if (item.item != there->items[0].item) continue;
    EXPECT_EQ(item.options, there->items[0].options);
    EXPECT_EQ(item.inputs[0].name, there->items[0].inputs[0].name);
    const auto a = ReadFile(RunIngest(item, "moved_a").artifact);
    const auto b = ReadFile(RunIngest(there->items[0], "moved_b").artifact);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(*a, *b);
  }
}

}  // namespace
}  // namespace mocurate
