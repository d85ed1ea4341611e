#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/npy.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

IngestOptions OneFile(const std::string& name, const std::string& bytes, const std::string& file = "a1_s2.txt") {
  const std::filesystem::path folder = FreshFolder(name);
  Put(folder / file, bytes);
  return SmallTable(folder);
}

std::string ConfigRefusal(const IngestOptions& options) {
  const auto discovery = Discover(options);
  if (discovery) return "found";
  EXPECT_EQ(ExitCodeOf(discovery.error().code), ExitCode::kUsage);
  return discovery.error().Message();
}

TEST(BadInput, AnEmptyFile) {
  const IngestOptions options = OneFile("empty", "");
  EXPECT_EQ(RefusalOf(options, "empty"), "a1_s2.txt: the file is empty (was it copied whole?)");
}

TEST(BadInput, RowsThatDoNotDivide) {
  IngestOptions options = OneFile("rows", "1 2 3\n4 5 6\n7 8 9\n");
  EXPECT_EQ(RefusalOf(options, "rows"), "done") << "what is whole is kept, with a finding";
  options.source.damaged_rows = DamagedRows::kRefuse;
  EXPECT_EQ(
      RefusalOf(options, "rows"),
      "a1_s2.txt:4: 3 rows are not a whole number of frames of 2 rows (1 left over) (check rows_per_frame; or a row "
      "is missing or too many, or the file is cut off)");
}

TEST(BadInput, NanWithoutADeclarationAndWithOne) {
  IngestOptions options = OneFile("nan", "1 2 3\nnan nan nan\n");
  options.source.damaged_rows = DamagedRows::kRefuse;
  EXPECT_THAT(RefusalOf(options, "nan"), HasSubstr("a1_s2.txt:2: 'nan' is not a finite number"));
  options.source.missing = MissingValue::kNan;
  const Ingested ingested = RunIngest(Discover(options)->items[0], "nan");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.evidence.tracks->confidence, (std::vector<double>{1.0, 0.0}));
  EXPECT_EQ(ingested.outcome->summary["missing_share"], 0.5);
}

TEST(BadInput, AClipInWhichNobodyIsSeen) {
  IngestOptions options = OneFile("nobody", "0 0 0\n0 0 0\n");
  options.source.missing = MissingValue::kZero;
  EXPECT_THAT(RefusalOf(options, "nobody"), HasSubstr("no joint is seen at all in 1 frame"));
}

TEST(BadInput, ATableOfZerosIsNoMotionAndSingleZerosAreSaid) {
  EXPECT_THAT(RefusalOf(OneFile("zeros", "0 0 0\n0 0 0\n"), "zeros"), HasSubstr("every joint of every frame is 0 0 0"));
  const Ingested ingested = RunIngest(Discover(OneFile("zero", "1 2 3\n0 0 0\n"))->items[0], "zero");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  ASSERT_EQ(ingested.outcome->findings.size(), 2u);
  EXPECT_EQ(ingested.outcome->findings[0].code, "zero_joint");
  EXPECT_EQ(ingested.outcome->findings[0].value, 1.0);
}

TEST(BadInput, AConfidenceBeyondOneIsNotBentIntoOne) {
  IngestOptions options = OneFile("percent", "1 2 3 87\n4 5 6 100\n");
  options.source.columns = {"x", "y", "z", "confidence"};
  const std::string refusal = RefusalOf(options, "percent");
  EXPECT_THAT(refusal, HasSubstr("confidence 87 of joint '"));
  EXPECT_THAT(refusal, HasSubstr("in frame 0 is not in 0..1"));
}

TEST(BadInput, AMisspeltFieldOfAName) {
  IngestOptions options = OneFile("field", "1 2 3\n4 5 6\n");
  options.source.person = "s{persn}";
  EXPECT_EQ(ConfigRefusal(options),
            "ingest.source.person: 's{persn}' names the field {persn}, which 'a{action}_s{person}.txt' does not have "
            "(did you mean {person}?)");
}

TEST(BadInput, AMissingUnitNamesTheWayOut) {
  IngestOptions options = OneFile("unit", "1 2 3\n4 5 6\n");
  options.source.units = "";
  EXPECT_EQ(ConfigRefusal(options),
            "ingest.source.units: source 'small' does not say its unit of length, and joint_table files do not either "
            "(write `units: m` (or cm, mm, inch) under ingest.source)");
  options.source.units = "milli";
  EXPECT_THAT(ConfigRefusal(options), HasSubstr("'milli' is no unit of length"));
}

TEST(BadInput, AUnitThatPutsThePersonFarAway) {
  IngestOptions options = OneFile("far", "1 2 2687\n4 5 2600\n");
  options.source.units = "m";
  EXPECT_THAT(RefusalOf(options, "far"),
              HasSubstr("a joint is 2687 m from the origin in frame 0 (is ingest.source.units right?"));
}

TEST(BadInput, MissingAxesRateAndJoints) {
  const IngestOptions options = OneFile("missing", "1 2 3\n4 5 6\n");
  IngestOptions changed = options;
  changed.source.axes = "";
  EXPECT_THAT(ConfigRefusal(changed), HasSubstr("ingest.source.axes: source 'small' does not say its axes"));
  changed.source.axes = "+x +x +z";
  EXPECT_NE(ConfigRefusal(changed), "found");
  changed = options;
  changed.source.rate_hz.reset();
  EXPECT_THAT(ConfigRefusal(changed), HasSubstr("does not say its frame rate"));
  changed = options;
  changed.source.joints.clear();
  EXPECT_THAT(ConfigRefusal(changed), HasSubstr("does not name its joints"));
  changed = options;
  changed.source.columns = {"x", "y", "depth"};
  EXPECT_THAT(ConfigRefusal(changed), HasSubstr("unknown column 'depth'"));
  changed.source.skeleton = "openni15";
  changed.source.joints = {"left_hipp", "right_hipp"};
  const std::string all = ConfigRefusal(changed);
  for (const char* part :
       {"unknown column 'depth'", "column 'z' must stand exactly once", "'left_hipp'", "'right_hipp'"})
    EXPECT_THAT(all, HasSubstr(part)) << "all at once";
}

TEST(BadInput, AnUnknownJoint) {
  IngestOptions options = OneFile("joint", "1 2 3\n4 5 6\n");
  options.source.skeleton = "openni15";
  options.source.joints = {"left_hip", "right_hipp"};
  EXPECT_EQ(ConfigRefusal(options),
            "ingest.source.joints: joint 'right_hipp' is unknown to skeleton 'openni15' (did you mean 'right_hip'?)");
  options.source.joints = {"left_hip", "left_hip"};
  EXPECT_THAT(ConfigRefusal(options), HasSubstr("joint 'left_hip' is listed twice"));
}

TEST(BadInput, ANameThatDoesNotMatchIsAFindingOrAFailureAndTheOthersStay) {
  IngestOptions options = OneFile("name", "1 2 3\n4 5 6\n");
  Put(options.path / "notes.txt", "hello");
  Put(options.path / "deeper" / "a1_s3.txt", "1 2 3\n4 5 6\n");
  auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 1u);
  ASSERT_EQ(discovery->left_out.size(), 2u);
  EXPECT_EQ(discovery->left_out[0].item, "notes.txt");
  EXPECT_EQ(discovery->left_out[1].item, "deeper");
  EXPECT_EQ(discovery->left_out[1].outcome.findings.at(0).code, "folder_not_read");
  EXPECT_EQ(discovery->left_out[1].outcome.findings.at(0).value, 1.0);
  const StageOutcome passed_over = discovery->left_out[0].outcome;
  EXPECT_EQ(passed_over.kind, OutcomeKind::kLeftOut);
  ASSERT_EQ(passed_over.findings.size(), 1u);
  EXPECT_EQ(passed_over.findings[0].clip, "notes.txt");
  EXPECT_EQ(passed_over.findings[0].code, "name_mismatch");
  EXPECT_EQ(passed_over.findings[0].severity, Severity::kWarning);
  EXPECT_THAT(passed_over.findings[0].message, HasSubstr("does not match the pattern 'a{action}_s{person}.txt'"));
  options.source.other_files = OtherFiles::kError;
  EXPECT_EQ(Discover(options)->left_out[0].outcome.kind, OutcomeKind::kRefused);
  options.source.other_files = OtherFiles::kIgnore;
  EXPECT_TRUE(Discover(options)->left_out.empty());
}

TEST(BadInput, ALabelThatIsNotListed) {
  IngestOptions options = OneFile("label", "1 2 3\n4 5 6\n");
  Put(options.path / "a9_s2.txt", "1 2 3\n4 5 6\n");
  options.source.labels = {{"1", "wave"}};
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->left_out[0].outcome.kind, OutcomeKind::kRefused);
  EXPECT_EQ(discovery->left_out[0].outcome.findings[0].code, "label_unknown");
  EXPECT_EQ(discovery->left_out[0].outcome.findings[0].severity, Severity::kError);
}

TEST(BadInput, AFolderThatIsNotThereOrHoldsNothing) {
  IngestOptions options = OneFile("folder", "1 2 3\n", "other.dat");
  EXPECT_THAT(Discover(options).error().Message(), HasSubstr("no file matches the pattern"));
  EXPECT_EQ(Discover(options).error().code, ErrorCode::kNotFound);
  options.path /= "nowhere";
  EXPECT_THAT(Discover(options).error().Message(), HasSubstr("the folder does not exist"));
  options.path.clear();
  EXPECT_THAT(Discover(options).error().Message(), HasSubstr("no folder with captures is given"));
}

TEST(BadInput, TheFolderOfATakeInsteadOfTheOneAbove) {
  IngestOptions options = OneFile("take", "1 2 3\n4 5 6\n");
  const std::filesystem::path above = options.path.parent_path();
  options.source.files = options.path.filename().string() + "/" + options.source.files;
  const auto discovery = Discover(options);
  ASSERT_FALSE(discovery);
  EXPECT_THAT(discovery.error().hint, HasSubstr("give " + above.string() + " (ingest.path)"));
}

TEST(BadInput, TwoFilesOfOneName) {
  IngestOptions options = OneFile("twins", "1 2 3\n4 5 6\n");
  Put(options.path / "a2_s2.txt", "1 2 3\n4 5 6\n");
  options.source.recording = "take";
  EXPECT_THAT(ConfigRefusal(options), HasSubstr("'a1_s2.txt' and 'a2_s2.txt' are both 'small/2/take'"));
}

TEST(JointTableSource, ConfidenceUnitsAxesRolesAndSeveralJointsPerRow) {
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

TEST(NpySource, HumanAct12NamesBecomeJointsOnlyMotion) {
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
  EXPECT_THAT(RefusalOf(options, "npy"), HasSubstr("the array has shape (2, 23, 3), (frames, 24, 3) is needed"));
  array.shape = {2, 24, 3};
  array.dtype = "<U1";
  array.values.clear();
  array.texts.assign(2 * 24 * 3, "x");
  Put(options.path / "P01G02R03F0004T0005A0607.npy", EncodeNpy(array, "texts").value());
  EXPECT_THAT(RefusalOf(options, "npy"), HasSubstr("the array holds texts"));
}

}  // namespace
}  // namespace mocurate
