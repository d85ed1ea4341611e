// Findings of the checks on the recorded sets, each verified by hand. Actions on synthetic defects.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "ingest/checks/finding_table.h"
#include "ingest/item_facts.h"
#include "ingest/known_issues.h"
#include "ingest/sources/source_file.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// "recording code joint begin-end" of every finding of a check in a source.
std::vector<std::string> Found(const std::string& source, const std::vector<std::string>& assignments = {}) {
  std::vector<std::string> lines;
  const SourceRun& run = RunOnce(Declared(source, assignments));
  if (!run.discovery) ADD_FAILURE() << run.discovery.error().Message();
  for (std::size_t i = 0; i < run.outcomes.size(); ++i) {
    const std::string& item = run.discovery->items[i].item;
    const auto& outcome = run.outcomes[i];
    if (!outcome) continue;
    for (const Finding& finding : outcome->findings) {
      if (const FindingKind* kind = FindFindingKind(finding.code); kind == nullptr || kind->check == Checked::kNothing)
        continue;
      lines.push_back(item.substr(item.rfind('/') + 1) + " " + finding.code +
                      (finding.joint.empty() ? "" : " " + finding.joint) + " " + std::to_string(finding.frame_begin) +
                      "-" + std::to_string(finding.frame_end));
    }
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

/// Pairs found by the comparison across a source: "later code".
std::vector<std::string> Repeated(const std::string& source, const std::vector<std::string>& assignments = {}) {
  const IngestOptions options = Declared(source, assignments);
  const SourceRun& run = RunOnce(options);
  StageRequest all;
  all.item = "duplicates";
  all.options = OptionsToJson(options.source.checks);
  all.output = run.folder / "found.json";
  for (std::size_t i = 0; i < run.outcomes.size(); ++i) {
    if (run.outcomes[i] && HasArtifact(run.outcomes[i]->kind))
      all.inputs.push_back({"evidence", run.discovery->items[i].item, run.Artifact(i), ""});
  }
  const auto outcome = DuplicatesStage(all);
  std::vector<std::string> lines;
  if (!outcome) {
    ADD_FAILURE() << outcome.error().Message();
    return lines;
  }
  for (std::size_t i = 0; i < outcome->findings.size(); ++i) {
    const std::string item = outcome->summary["items"][i];
    const std::string& message = outcome->findings[i].message;
    const std::size_t begin = message.find('\'') + 1;
    const std::string other = message.substr(begin, message.find('\'', begin) - begin);
    lines.push_back(item.substr(item.rfind('/') + 1) + " " + outcome->findings[i].code + " " +
                    other.substr(other.rfind('/') + 1));
  }
  return lines;
}

TEST_F(RecordedSets, KardRepeatsHeadPositionsAndHasOnePositionJump) {
  EXPECT_THAT(Found("kard"),
              ElementsAre("a01_s08_e01 repeated_value head 39-48", "a04_s03_e02 repeated_value head 92-96",
                          "a06_s08_e02 repeated_value head 27-55", "a06_s08_e03 repeated_value head 27-40",
                          "a08_s08_e03 repeated_value head 38-49", "a14_s02_e03 repeated_value left_hand 81-84",
                          "a14_s04_e01 position_jump 0-1", "a16_s08_e03 repeated_value head 45-67"));
  EXPECT_THAT(Repeated("kard"), IsEmpty()) << "no duplicate files";
}

TEST_F(RecordedSets, MsrAction3dSwapsSidesWhenItsTrackerMistakesTheFacing) {
  EXPECT_THAT(Found("msr_action3d"),
              ElementsAre("a01_s02_e01 swapped_sides 48-55", "a01_s02_e02 frozen_frames 25-27",
                          "a02_s08_e03 swapped_sides 0-11", "a12_s08_e02 frozen_frames 11-13",
                          "a13_s01_e01 unrecovered_jump 29-31", "a13_s08_e01 swapped_sides 52-55",
                          "a13_s08_e01 unrecovered_jump 43-45", "a14_s03_e03 frozen_frames 24-26",
                          "a17_s03_e02 swapped_sides 0-6", "a18_s04_e01 swapped_sides 39-48",
                          "a19_s01_e01 unrecovered_jump 50-52", "a19_s09_e02 swapped_sides 26-37"))
      << "the track returns from below the floor";
}

TEST_F(RecordedSets, ClipsThatShareFramesAreReportedInMsrAction3dOnly) {
  EXPECT_THAT(Repeated("msr_action3d", {"ingest.source.known_issues=report"}),
              ElementsAre("a05_s01_e02 shared_frames a05_s01_e01", "a13_s02_e03 shared_frames a13_s02_e02",
                          "a14_s09_e01 shared_frames a13_s09_e03", "a14_s09_e02 shared_frames a13_s09_e03",
                          "a14_s09_e03 shared_frames a13_s09_e03"));
  EXPECT_THAT(Repeated("utkinect"), IsEmpty()) << "neighbours share at most three frames";
}

TEST_F(RecordedSets, OtherSetsHaveNoFindings) {
  EXPECT_THAT(Found("utkinect"),
              ElementsAre("pickUp_s06_e01 unrecovered_jump 0-2", "walk_s06_e01 unrecovered_jump 0-2"));
  for (const char* source : {"florence3d", "cad60", "ntu", "bandai2", "hdm05", "cmu_amc"}) {
    EXPECT_THAT(Found(source), IsEmpty()) << source;
  }
  for (const char* source : {"florence3d", "cad60", "ntu", "bandai2", "hdm05"}) {
    EXPECT_THAT(Repeated(source), IsEmpty()) << source;
  }
}

TEST_F(RecordedSets, JumpsRevealAFrameRateThatIsTooHigh) {
  for (const char* rate : {"240 Hz", "480 Hz"}) {
    EXPECT_THAT(Found("cmu_amc", {std::string("ingest.source.rate=") + rate, "ingest.source.files='01_{take:2}.amc'",
                                  "ingest.source.person='1'", "ingest.source.recording='{take}'",
                                  "ingest.source.skeleton_files=01.asf"}),
                ElementsAre("01 rate_suspect 0-0"))
        << rate;
  }
}

TEST_F(RecordedSets, ListedMsrAction3dSkeletonsAreFoundByTheirBlankFrames) {
  // Two of the nine listed files (a02_s03_e02, a04_s03_e01) have no blank frames; their defect is another one.
  const auto issues = KnownIssues::Load({"msr_action3d_excluded"});
  ASSERT_TRUE(issues) << issues.error().Message();
  const auto discovery = Discover(Declared("msr_action3d", {"ingest.source.known_issues=report"}));
  int listed = 0, found = 0;
  for (const ItemSpec& item : discovery->items) {
    if (!issues->Find(item.item.substr(item.item.rfind('/') + 1))) continue;
    ++listed;
    EXPECT_NE(FactsOf(item).known_issue, "");
    StageRequest request;
    request.item = item.item;
    request.options = item.options.Whole();
    request.inputs = item.inputs;
    request.output = FreshFolder("listed") / "clip.h5";
    const auto outcome = IngestStage(request);
    bool blank = !outcome;
    for (const Finding& finding : outcome ? outcome->findings : std::vector<Finding>()) {
      blank |= finding.code == "no_joint_seen";
    }
    found += blank ? 1 : 0;
  }
  EXPECT_EQ(listed, 9);
  EXPECT_EQ(found, 7);
}

TEST_F(RecordedSets, Ntu60IssueListIsPartOfThatOfNtu120) {
  const auto small = KnownIssues::Load({"ntu60_missing_skeletons"});
  const auto large = KnownIssues::Load({"ntu120_missing_skeletons"});
  ASSERT_TRUE(small && large);
  EXPECT_TRUE(small->Find("S001C002P005R002A008"));
  EXPECT_TRUE(large->Find("S001C002P005R002A008"));
  EXPECT_TRUE(large->Find("nturgb+d_skeletons.S001C002P005R002A008"));
  EXPECT_FALSE(large->Find("S001C001P001R001A011"));
  const auto discovery = Discover(Declared("ntu"));
  for (const ItemSpec& item : discovery->items) EXPECT_EQ(FactsOf(item).known_issue, "");
}

TEST(KnownIssueLists, SuggestTheNearestNameForAnUnknownList) {
  const auto issues = KnownIssues::Load({"ntu60_missing_skeleton"});
  ExpectError(issues, ErrorCode::kNotFound, "ingest.source.known_issue_lists");
  EXPECT_THAT(issues.error().Message(), HasSubstr("'ntu60_missing_skeletons'"));
  EXPECT_TRUE(MatchesWildcard("*50002_one*", "DFaust_67.50002.50002_one_leg_jump_poses"));
  EXPECT_FALSE(MatchesWildcard("50002_one", "DFaust_67.50002_one_leg_jump"));
}

TEST(KnownIssueLists, CustomListDropsReportsOrIgnoresAndRequiresASource) {
  IngestOptions options = SmallTable(FreshFolder("listed_own"));
  for (const char* name : {"a1_s1.txt", "a2_s1.txt"}) {
    Put(options.path / name, "1 2 3\n4 5 6\n1 3 3\n4 6 6\n2 3 3\n5 6 7\n");
  }
  const auto list = FreshFolder("listed_file") / "mine.yaml";
  Put(list, "issues:\n  - {kind: broken, source: Miller, note: falls over, clips: [a1_s1]}\n");
  options.source.known_issue_lists = {list.string()};
  options.source.known_issues = KnownIssueAction::kDrop;
  auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->excluded.at(0).outcome.findings.at(0).code, "known_issue");
  EXPECT_THAT(discovery->excluded.at(0).outcome.error.what,
              AllOf(HasSubstr("broken"), HasSubstr("falls over"), HasSubstr("Miller")));
  options.source.known_issues = KnownIssueAction::kReport;
  discovery = Discover(options);
  ASSERT_EQ(discovery->items.size(), 2u);
  const Ingested ingested = RunIngest(discovery->items.at(0), "known_issue");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.outcome->findings.at(0).code, "known_issue");
  options.source.known_issues = KnownIssueAction::kIgnore;
  EXPECT_EQ(RunIngest(Discover(options)->items.at(0), "silent").outcome->findings.size(), 0u);
  Put(list, "issues:\n  - {kind: broken, source: '${HOME}', clips: [a1_s1]}\n");
  EXPECT_EQ(KnownIssues::Load({list.string()})->Find("a1_s1")->source, "${HOME}") << "data name no environment";
  Put(list, "include: /dev/zero\nissues: []\n");
  ExpectError(Discover(options), ErrorCode::kConfig, list.string() + ":1:1");
  Put(list, "issues:\n  - {kind: broken, clips: [a1_s1]}\n");
  ExpectError(Discover(options), ErrorCode::kConfig, list.string());
}

/// A table of a swaying person with KARD's joints, edited by `plant`.
template <class Plant>
IngestOptions Swaying(const std::string& folder, Plant plant) {
  IngestOptions options = Declared("kard");
  options.path = FreshFolder(folder);
  const double rest[15][3] = {{0, 1600, 0},    {0, 1400, 0},    {200, 1380, 0},  {420, 1200, 0}, {600, 1000, 0},
                              {-200, 1380, 0}, {-420, 1200, 0}, {-600, 1000, 0}, {0, 1150, 0},   {100, 900, 0},
                              {100, 500, 0},   {100, 100, 0},   {-100, 900, 0},  {-100, 500, 0}, {-100, 100, 0}};
  std::string text;
  for (int f = 0; f < 40; ++f) {
    for (int j = 0; j < 15; ++j) {
      Vector3d place(rest[j][0] + 80.0 * std::sin(0.2 * f + 0.1 * j), rest[j][1], 2500.0 + 2.0 * f + j);
      plant(f, j, place);
      char row[96];
      std::snprintf(row, sizeof row, "%.3f %.3f %.3f\n", place.x(), place.y(), place.z());
      text += row;
    }
  }
  Put(options.path / "a01_s01_e01_realworld.txt", text);
  return options;
}

Ingested OnlyClip(const IngestOptions& options, const std::string& name) {
  return RunIngest(Discover(options)->items.at(0), name);
}

TEST(ClipChecks, ReportAPositionJumpAndMarkItMissingOnRequest) {
  IngestOptions options =
      Swaying("far", [](int f, int, Vector3d& place) { place.z() += f >= 20 && f < 25 ? 2e6 : 0.0; });
  const Ingested ingested = OnlyClip(options, "far");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  ASSERT_EQ(ingested.outcome->findings.size(), 1u);
  EXPECT_EQ(ingested.outcome->findings[0].code, "position_jump");
  EXPECT_EQ(ingested.outcome->findings[0].frame_begin, 20);
  EXPECT_NEAR(ingested.outcome->findings[0].value, 2000.0, 1.0);
  EXPECT_EQ(ingested.outcome->summary["missing_share"], 0.0) << "by default the jump is only reported";
  options.source.checks.actions = {{"position_jump", OnFinding::kMissing}};
  const Ingested missing = OnlyClip(options, "far");
  ASSERT_TRUE(missing.outcome);
  EXPECT_EQ(missing.outcome->findings[0].action, FindingAction::kMissing);
  EXPECT_DOUBLE_EQ(missing.outcome->summary["missing_share"].get<double>(), 5.0 / 40.0);
}

TEST(ClipChecks, ExcludeDroppedClipsWithValueAndLimit) {
  IngestOptions options = Swaying("swap", [](int, int, Vector3d&) {});
  EXPECT_TRUE(OnlyClip(options, "sound").outcome->findings.empty());
  options = Swaying("hangs", [](int f, int j, Vector3d& place) {
    if (f >= 1) place = Vector3d(10.0 * j, 100.0 * j, 2500.0);
  });
  StageRequest request;
  const ItemSpec item = Discover(options)->items.at(0);
  request.item = item.item;
  request.options = item.options.Whole();
  request.inputs = item.inputs;
  request.output = FreshFolder("hangs_out") / "clip.h5";
  auto outcome = IngestStage(request);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->kind, OutcomeKind::kExcluded);
  EXPECT_EQ(outcome->findings.back().action, FindingAction::kDropped);
  EXPECT_THAT(outcome->findings.back().code, ::testing::AnyOf("motionless_clip", "not_joint_positions"));
  EXPECT_GT(outcome->summary["threshold"].get<double>(), 0.0);
  EXPECT_FALSE(std::filesystem::exists(request.output));
}

TEST(ClipChecks, ReadLimitsAndActionsByCode) {
  const auto read = [](const std::string& text) -> Expected<CheckOptions> {
    const auto node = LoadConfig(ConfigSource{text, "checks.yaml", {}}, {});
    return node ? OptionsFromConfig<CheckOptions>(*node) : Forward(node);
  };
  const auto options = read("swapped_sides: {ratio: 0.3, action: missing}\nposition_jump: {distance: 20 cm}\n");
  ASSERT_TRUE(options) << options.error().Message();
  const auto kept = OptionsFromJson<CheckOptions>(OptionsToJson(*options), "checks");
  ASSERT_TRUE(kept) << kept.error().Message();
  EXPECT_EQ(kept->Limit("swapped_sides", "ratio"), 0.3);
  EXPECT_EQ(kept->Limit("swapped_sides", "step"), CheckOptions().Limit("swapped_sides", "step"));
  EXPECT_DOUBLE_EQ(kept->Limit("position_jump", "distance"), 0.2);
  EXPECT_EQ(kept->ActionFor("swapped_sides"), OnFinding::kMissing);
  EXPECT_EQ(kept->ActionFor("not_joint_positions"), OnFinding::kDrop);
  EXPECT_EQ(kept->limits.size(), 2u);
  ExpectError(read("teleports: {action: drop}\n"), ErrorCode::kConfig, "checks.yaml:1:1");
  ExpectError(read("position_jump:\n  action: remove\n"), ErrorCode::kConfig, "checks.yaml:2:11");
  ExpectError(read("repeated_value:\n  frames: 2.5\n"), ErrorCode::kConfig, "checks.yaml:2:11");
}

TEST(ClipChecks, ReportAClipLongerThanItsNameStates) {
  IngestOptions options = Swaying("name", [](int, int, Vector3d&) {});
  std::filesystem::rename(options.path / "a01_s01_e01_realworld.txt", options.path / "s01a01F0100T0138.txt");
  options.source.files = "s{person:2}a{action:2}F{first:4}T{last:4}.txt";
  options.source.recording = "{first}";
  options.source.frames_in_name = "{first}-{last}";
  const Ingested ingested = OnlyClip(options, "name");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  ASSERT_EQ(ingested.outcome->findings.size(), 1u);
  EXPECT_EQ(ingested.outcome->findings[0].code, "name_contradiction");
  EXPECT_EQ(ingested.outcome->findings[0].value, 40.0);
}

TEST_F(RecordedSets, TwoPeopleOfOneRecordingAreNotDuplicates) { EXPECT_THAT(Repeated("pose2sim_two"), ElementsAre()); }

TEST(ClipChecks, ReportADuplicateTakeAndDropItOnRequest) {
  IngestOptions options = Swaying("twice", [](int, int, Vector3d&) {});
  std::filesystem::copy_file(options.path / "a01_s01_e01_realworld.txt", options.path / "a02_s01_e01_realworld.txt");
  StageRequest all;
  all.options = OptionsToJson(options.source.checks);
  all.output = FreshFolder("twice_out") / "found.json";
  const auto discovery = Discover(options);
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "twice" + std::to_string(all.inputs.size()));
    all.inputs.push_back({"evidence", item.item, ingested.artifact, ""});
  }
  auto outcome = DuplicatesStage(all);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  ASSERT_EQ(outcome->findings.size(), 1u);
  EXPECT_EQ(outcome->findings[0].code, "duplicate");
  EXPECT_EQ(outcome->summary["items"][0], "kard/s01/a02_s01_e01");
  EXPECT_TRUE(outcome->summary["dropped"].empty());
  EXPECT_THAT(Codes(InspectPath(options.path, std::nullopt), "warning"), Contains("duplicate"));
  options.source.checks.actions = {{"duplicate", OnFinding::kDrop}};
  all.options = OptionsToJson(options.source.checks);
  EXPECT_TRUE(DuplicatesStage(all)->summary["dropped"].contains("kard/s01/a02_s01_e01"));
}

}  // namespace
}  // namespace mocurate
