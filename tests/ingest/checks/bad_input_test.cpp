#include <gtest/gtest.h>

#include "core/formats/npy.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

IngestOptions OneFile(const std::string& name, const std::string& bytes, const std::string& file = "a1_s2.txt") {
  const std::filesystem::path folder = FreshFolder(name);
  Put(folder / file, bytes);
  return SmallTable(folder);
}

void ExpectConfigError(const IngestOptions& options, const std::string& key) {
  ExpectError(Discover(options), ErrorCode::kConfig, "ingest.source." + key);
}

TEST(BadInput, RejectsAnEmptyFile) {
  const IngestOptions options = OneFile("empty", "");
  ExpectMalformed(IngestOnly(options, "empty"), "a1_s2.txt");
}

TEST(BadInput, ReportsAnIncompleteLastFrame) {
  IngestOptions options = OneFile("rows", "1 2 3\n4 5 6\n7 8 9\n");
  EXPECT_TRUE(IngestOnly(options, "rows")) << "complete frames are kept, with a finding";
  options.source.damaged_rows = DamagedRows::kRefuse;
  ExpectMalformed(IngestOnly(options, "rows"), "a1_s2.txt:4");
}

TEST(BadInput, RejectsNanUnlessDeclared) {
  IngestOptions options = OneFile("nan", "1 2 3\nnan nan nan\n");
  options.source.damaged_rows = DamagedRows::kRefuse;
  ExpectMalformed(IngestOnly(options, "nan"), "a1_s2.txt:2");
  options.source.missing = MissingValue::kNan;
  const Ingested ingested = RunIngest(Discover(options)->items[0], "nan");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.evidence.tracks->confidence, (std::vector<double>{1.0, 0.0}));
  EXPECT_EQ(ingested.outcome->summary["missing_share"], 0.5);
}

TEST(BadInput, RejectsAClipWithoutValidSamples) {
  IngestOptions options = OneFile("no_person", "0 0 0\n0 0 0\n");
  options.source.missing = MissingValue::kZero;
  ExpectError(IngestOnly(options, "no_person"), ErrorCode::kInconsistent, "a1_s2.txt");
}

TEST(BadInput, RejectsATableOfZerosAndReportsSingleZeros) {
  ExpectError(IngestOnly(OneFile("zeros", "0 0 0\n0 0 0\n"), "zeros"), ErrorCode::kInconsistent, "a1_s2.txt");
  const Ingested ingested = RunIngest(Discover(OneFile("zero", "1 2 3\n0 0 0\n"))->items[0], "zero");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  ASSERT_EQ(ingested.outcome->findings.size(), 2u);
  EXPECT_EQ(ingested.outcome->findings[0].code, "zero_joint");
  EXPECT_EQ(ingested.outcome->findings[0].value, 1.0);
}

TEST(BadInput, RejectsConfidencesAboveOne) {
  IngestOptions options = OneFile("percent", "1 2 3 87\n4 5 6 100\n");
  options.source.columns = {"x", "y", "z", "confidence"};
  ExpectError(IngestOnly(options, "percent"), ErrorCode::kInconsistent, "a1_s2.txt");
}

TEST(BadInput, RejectsAMisspeltNameField) {
  IngestOptions options = OneFile("field", "1 2 3\n4 5 6\n");
  options.source.person = "s{persn}";
  ExpectConfigError(options, "person");
}

TEST(BadInput, RejectsAMissingOrUnknownUnit) {
  IngestOptions options = OneFile("unit", "1 2 3\n4 5 6\n");
  for (const char* unit : {"", "milli"}) {
    options.source.units = unit;
    ExpectConfigError(options, "units");
  }
}

TEST(BadInput, RejectsAUnitThatPutsThePersonFarAway) {
  IngestOptions options = OneFile("far", "1 2 2687\n4 5 2600\n");
  options.source.units = "m";
  ExpectError(IngestOnly(options, "far"), ErrorCode::kInconsistent, "a1_s2.txt");
}

TEST(BadInput, RejectsMissingAxesRateAndJoints) {
  const IngestOptions options = OneFile("missing", "1 2 3\n4 5 6\n");
  IngestOptions changed = options;
  changed.source.axes = "";
  ExpectConfigError(changed, "axes");
  changed.source.axes = "+x +x +z";
  EXPECT_FALSE(Discover(changed));
  changed = options;
  changed.source.rate_hz.reset();
  ExpectConfigError(changed, "rate");
  changed = options;
  changed.source.joints.clear();
  ExpectConfigError(changed, "joints");
  changed = options;
  changed.source.columns = {"x", "y", "z", "depth"};
  ExpectConfigError(changed, "columns");
  changed.source.columns = {"x", "y", "depth"};
  ExpectError(Discover(changed), ErrorCode::kConfig, "");  // several errors
}

TEST(BadInput, RejectsUnknownAndRepeatedJoints) {
  IngestOptions options = OneFile("joint", "1 2 3\n4 5 6\n");
  options.source.skeleton = "openni15";
  for (const char* second : {"right_hipp", "left_hip"}) {
    options.source.joints = {"left_hip", second};
    ExpectConfigError(options, "joints");
  }
}

TEST(BadInput, ReportsOrRefusesAFileNameThatDoesNotMatch) {
  IngestOptions options = OneFile("name", "1 2 3\n4 5 6\n");
  Put(options.path / "notes.txt", "hello");
  Put(options.path / "deeper" / "a1_s3.txt", "1 2 3\n4 5 6\n");
  auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 1u);
  ASSERT_EQ(discovery->excluded.size(), 2u);
  EXPECT_EQ(discovery->excluded[0].item, "notes.txt");
  EXPECT_EQ(discovery->excluded[1].item, "deeper");
  EXPECT_EQ(discovery->excluded[1].outcome.findings.at(0).code, "folder_not_read");
  EXPECT_EQ(discovery->excluded[1].outcome.findings.at(0).value, 1.0);
  const Outcome passed_over = discovery->excluded[0].outcome;
  EXPECT_EQ(passed_over.kind, OutcomeKind::kExcluded);
  ASSERT_EQ(passed_over.findings.size(), 1u);
  EXPECT_EQ(passed_over.findings[0].clip, "notes.txt");
  EXPECT_EQ(passed_over.findings[0].code, "name_mismatch");
  EXPECT_EQ(passed_over.findings[0].severity, Severity::kWarning);
  options.source.other_files = OtherFiles::kError;
  EXPECT_EQ(Discover(options)->excluded[0].outcome.kind, OutcomeKind::kRefused);
  options.source.other_files = OtherFiles::kIgnore;
  EXPECT_TRUE(Discover(options)->excluded.empty());
}

TEST(BadInput, RejectsAnUnlistedLabel) {
  IngestOptions options = OneFile("label", "1 2 3\n4 5 6\n");
  Put(options.path / "a9_s2.txt", "1 2 3\n4 5 6\n");
  options.source.labels = {{"1", "wave"}};
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].outcome.kind, OutcomeKind::kRefused);
  EXPECT_EQ(discovery->excluded[0].outcome.findings[0].code, "label_unknown");
  EXPECT_EQ(discovery->excluded[0].outcome.findings[0].severity, Severity::kError);
}

TEST(BadInput, RejectsAMissingOrEmptyFolder) {
  IngestOptions options = OneFile("folder", "1 2 3\n", "other.dat");
  ExpectError(Discover(options), ErrorCode::kNotFound, options.path.string());
  options.source.files = options.path.filename().string() + "/other.dat";  // matches from the parent folder
  ExpectError(Discover(options), ErrorCode::kNotFound, options.path.string());
  options.path /= "nowhere";
  ExpectError(Discover(options), ErrorCode::kNotFound, options.path.string());
  options.path.clear();
  ExpectError(Discover(options), ErrorCode::kNotFound, "ingest.path");
}

TEST(BadInput, RejectsTwoFilesWithTheSameId) {
  IngestOptions options = OneFile("twins", "1 2 3\n4 5 6\n");
  Put(options.path / "a2_s2.txt", "1 2 3\n4 5 6\n");
  options.source.recording = "take";
  ExpectConfigError(options, "recording");
}

TEST(JointTableSource, AppliesConfidenceUnitsAxesRolesAndJointsPerRow) {
  IngestOptions options = OneFile("columns", "100 200 300 1 0  400 500 600 0.5 0\n");
  options.source.rows_per_frame = 1;
  options.source.columns = {"x", "y", "z", "confidence", "skip"};
  options.source.units = "cm";
  options.source.axes = "+x +z -y";
  options.source.roles = {{"2", "test"}};
  options.source.session = "day{action}";
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "columns");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const JointTracks& tracks = *ingested.clip.evidence.tracks;
  EXPECT_TRUE(tracks.positions.at(0, 0).isApprox(Vector3d(1, -3, 2), 1e-6)) << tracks.positions.at(0, 0).transpose();
  EXPECT_DOUBLE_EQ(tracks.confidence[1], 0.5);
  EXPECT_EQ(ingested.clip.role, "test");
  EXPECT_EQ(ingested.clip.identity.session, "day1");
}

TEST(NpySource, ReadsHumanAct12ArraysAsJointPositions) {
  IngestOptions options = Declared("humanact12_npy");
  options.path = FreshFolder("npy");
  NpyArray array;
  array.shape = {2, 24, 3};
  array.dtype = "<f4";
  array.values.assign(2 * 24 * 3, 0.5);
  Put(options.path / "P01G02R03F0004T0005A0607.npy", WriteNpy(array));
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "npy");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.id(), "humanact12/P01/P01G02R03F0004T0005A0607#0-2");
  EXPECT_EQ(ingested.clip.label, "lift_dumbbell");
  ASSERT_TRUE(ingested.clip.motion);
  EXPECT_TRUE(ingested.clip.motion->joints_only());
  EXPECT_TRUE(ingested.clip.motion->joints.at(1, 3).isApprox(Vector3d(0.5, -0.5, -0.5)));
  array.shape = {2, 23, 3};
  array.values.resize(2 * 23 * 3);
  Put(options.path / "P01G02R03F0004T0005A0607.npy", WriteNpy(array));
  ExpectError(IngestOnly(options, "npy"), ErrorCode::kInconsistent, "P01G02R03F0004T0005A0607.npy");
  array.shape = {2, 24, 3};
  array.dtype = "<U1";
  array.values.clear();
  array.texts.assign(2 * 24 * 3, "x");
  Put(options.path / "P01G02R03F0004T0005A0607.npy", EncodeNpy(array, "texts").value());
  ExpectError(IngestOnly(options, "npy"), ErrorCode::kInconsistent, "P01G02R03F0004T0005A0607.npy");
}

}  // namespace
}  // namespace mocurate
