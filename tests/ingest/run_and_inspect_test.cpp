// What is wrong with files is told by a run as it is by an inspection.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/npy.h"
#include "core/formats/npz.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/phspd_text.h"
#include "ingest/synthetic/studio_layouts.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

/// AMASS files whose path of the root is multiplied.
fs::path AmassIn(double factor, const std::string& name) {
  const fs::path folder = FreshFolder(name);
  StudioOptions studio;
  studio.layout = StudioLayout::kAmass;
  studio.seed = 3;
  EXPECT_TRUE(WriteStudioLayout(studio, folder / "written", 1));
  for (const auto& entry : fs::recursive_directory_iterator(folder / "written/amass")) {
    if (entry.path().extension() != ".npz") continue;
    const std::string bytes = *ReadFile(entry.path());
    Npz archive = *ParseNpz(bytes, "a");
    for (NpzMember& member : archive.members) {
      if (member.name != "trans") continue;
      for (double& value : member.array.values) value *= factor;
    }
    const auto written = EncodeNpz(archive, "a");
    EXPECT_TRUE(written);
    Put(entry.path(), written ? *written : "");
  }
  return folder / "written/amass";
}

TEST(RunAndInspect, APathOfTheRootInCentimetresIsToldOfAmassByBoth) {
  for (const double factor : {1.0, 100.0}) {
    const fs::path folder = AmassIn(factor, "amass_unit");
    IngestOptions options = Declared("amass");
    options.path = folder;
    const auto clips = RunAll(options);
    const Json inspection = InspectPath(folder, options.source);
    ASSERT_EQ(clips.size(), 2u);
    for (const ItemResult& clip : clips) {
      if (factor == 1.0)
        EXPECT_THAT(ErrorCodes(clip.outcome), Not(Contains("units_contradiction")));
      else
        EXPECT_THAT(ErrorCodes(clip.outcome), Contains("units_contradiction"));
    }
    EXPECT_EQ(Codes(inspection, "error").size(), factor == 1.0 ? 0u : 2u) << inspection.at("findings").dump(1);
  }
}

TEST_F(RecordedFormats, NumbersThatAreNoPersonsCostTheirJointAndAreToldByBoth) {
  const fs::path recorded = fs::path(std::getenv("MOCURATE_DATA")) / "kinect/kard/a01_s01_e01_realworld.txt";
  for (const auto& [row, code] :
       {std::pair<std::string, std::string>{"1e300 4 5", "number_too_large"}, {"1e300 nan inf", "not_a_number"}}) {
    IngestOptions options = Declared("kard");
    options.path = FreshFolder("kard_far");
    std::string text = *ReadFile(recorded);
    std::size_t begin = 0;
    for (int line = 0; line < 15 * 6 + 2; ++line) begin = text.find('\n', begin) + 1;
    text.replace(begin, text.find('\n', begin) - begin, row);
    Put(options.path / recorded.filename(), text);
    const auto clips = RunAll(options);
    ASSERT_EQ(clips.size(), 1u);
    EXPECT_EQ(clips[0].outcome.kind, OutcomeKind::kDone) << "a frame is lost, no clip";
    ASSERT_FALSE(clips[0].outcome.findings.empty());
    EXPECT_EQ(clips[0].outcome.findings[0].code, code);
    EXPECT_EQ(clips[0].outcome.findings[0].frame_begin, 6);
    EXPECT_THAT(clips[0].outcome.findings[0].message, HasSubstr("a01_s01_e01_realworld.txt:93: "));
    for (const std::optional<SourceOptions>& source : {std::optional<SourceOptions>(options.source), {}}) {
      const Json findings = Json(InspectPath(options.path, source)).at("findings");
      EXPECT_THAT(findings.dump(), HasSubstr("\"" + code + "\""));
      for (const Json& finding : findings) EXPECT_FALSE(finding.at("value").is_null()) << finding;
    }
  }
}

const char* const kBvh =
    "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n"
    "MOTION\n";

class CutFiles : public WrittenFormats {
 protected:
  /// The findings of severity error of a run and of an inspection, and the frames that both keep.
  void ExpectBoth(const std::string& motion, const std::vector<std::string>& codes, int frames) {
    const fs::path file = Written("walk_p1.bvh", kBvh + motion);
    const Json inspection = InspectPath(file, std::nullopt);
    EXPECT_EQ(Codes(inspection, "error"), codes) << motion;
    ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
    EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), frames);
    IngestOptions options;
    options.path = folder_;
    options.source.name = "cut";
    options.source.format = "bvh";
    options.source.files = "{action}_{person}.bvh";
    options.source.units = "cm";
    options.source.axes = "+x +y +z";
    const auto clips = RunAll(options);
    ASSERT_EQ(clips.size(), 1u);
    EXPECT_EQ(ErrorCodes(clips[0].outcome), codes) << motion;
    EXPECT_EQ(clips[0].outcome.summary.at("frames"), frames);
    EXPECT_EQ(clips[0].outcome.kind, codes.empty() ? OutcomeKind::kDone : OutcomeKind::kDoubtful);
  }
};

TEST_F(CutFiles, WholeRowsOfABvhAreKeptByBothAndWhatIsMissingIsAnError) {
  const std::string rows = "1 90 0\n2 90 0\n3 90 0\n";
  ExpectBoth("Frames: 3\nFrame Time: 0.033\n" + rows, {}, 3);
  ExpectBoth("Frames: 5\nFrame Time: 0.033\n" + rows, {"count_contradiction"}, 3);
  ExpectBoth("Frames: 4\nFrame Time: 0.033\n" + rows + "4 9", {"cut_off", "count_contradiction"}, 3);
  ExpectBoth("Frames: 4\nFrame Time: 0.033\n" + rows + "4 90\n", {"cut_off", "count_contradiction"}, 3);
  ExpectBoth("Frames: 4\nFrame Time: 0.033\n" + rows + "4 -", {"cut_off", "count_contradiction"}, 3);
  ExpectBoth("Frames: 4\nFrame Time: 0.033\n" + rows + "4 90 1.5e", {"cut_off", "count_contradiction"}, 3);
}

TEST_F(CutFiles, ASkeletonFileWithoutFramesIsNamedAsThat) {
  const Json inspection = InspectPath(Written("S001C001P001R001A001.skeleton", "0\n"), std::nullopt);
  ASSERT_EQ(inspection.at("findings").size(), 1u) << inspection.dump(1);
  EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr("0 frames"));
  EXPECT_THAT(inspection.at("findings")[0].at("code"), Not("unknown_format"));
}

TEST(RunAndInspect, ARootThatIsAKilometreAwayForFiveFramesIsATeleportOfPhspdInBoth) {
  const fs::path folder = FreshFolder("phspd_far");
  StudioOptions studio;
  studio.layout = StudioLayout::kPhspd;
  studio.seed = 4;
  studio.subjects = 1;
  studio.depth.enabled = false;
  ASSERT_TRUE(WriteStudioLayout(studio, folder / "written", 1));
  IngestOptions options = Declared("phspd");
  options.path = folder / "written/phspd";
  int far = -1;
  for (const auto& entry : fs::recursive_directory_iterator(options.path)) {
    if (entry.path().filename() != "pose.txt" || far >= 0) continue;
    PhspdPose pose = *ParsePhspdPose(*ReadFile(entry.path()), "pose.txt");
    ASSERT_GT(pose.frame.size(), 40u);
    far = pose.frame[20] - pose.frame[0];
    for (std::size_t row = 20; row < 25; ++row) {
      for (std::size_t i = 0; i < 3 * kPhspdJoints; i += 3) pose.position_m[row * 3 * kPhspdJoints + i] += 1000.0;
    }
    Put(entry.path(), WritePhspdPose(pose));
  }
  const std::string at = " frames " + std::to_string(far) + "-";
  std::size_t told = 0;
  for (const ItemResult& clip : RunAll(options)) {
    for (const Finding& finding : clip.outcome.findings)
      told += finding.code == "teleport" && finding.frame_begin == far ? 1 : 0;
  }
  EXPECT_EQ(told, 1u);
  const Json inspection = InspectPath(options.path, options.source);
  told = 0;
  for (const Json& finding : inspection.at("findings")) {
    const std::string where = finding.at("where");
    told += finding.at("code") == "teleport" && where.find(at) != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(told, 1u) << inspection.at("findings").dump(1);
}

TEST(RunAndInspect, WhatLiesBesideThePosesOfPhspdIsKnownAndAPoseInAFolderOfAnotherNameIsTold) {
  const fs::path folder = FreshFolder("phspd_beside");
  StudioOptions studio;
  studio.layout = StudioLayout::kPhspd;
  studio.subjects = 1;
  studio.depth.enabled = false;
  ASSERT_TRUE(WriteStudioLayout(studio, folder / "written", 1));
  IngestOptions options = Declared("phspd");
  options.path = folder / "written/phspd";
  const auto whole = Discover(options);
  ASSERT_TRUE(whole) << whole.error().Message();
  EXPECT_TRUE(whole->left_out.empty()) << whole->left_out.front().item;
  EXPECT_TRUE(whole->findings.empty()) << whole->findings.front().message;
  fs::rename(fs::path(whole->items[0].inputs[0].path).parent_path(), options.path / "pose/somebody");
  const auto renamed = Discover(options);
  ASSERT_TRUE(renamed) << renamed.error().Message();
  ASSERT_EQ(renamed->findings.size(), 1u);
  EXPECT_THAT(renamed->findings[0].message, HasSubstr("pose/somebody/pose.txt"));
}

class CutTables : public RecordedFormats {};

TEST_F(CutTables, ATableThatEndsWithinAFrameKeepsItsWholeFramesInBothDeclaredOrNot) {
  IngestOptions options = Declared("kard");
  const std::string text = *ReadFile(options.path / "a01_s01_e01_realworld.txt");
  std::size_t row = 0;
  for (int line = 0; line < 200; ++line) row = text.find('\n', row) + 1;  // 13 frames of 15 rows, and 5 rows
  options.path = FreshFolder("cut_table");
  for (const std::string& bytes : {text.substr(0, row), text.substr(0, row + 3)}) {
    Put(options.path / "a01_s01_e01_realworld.txt", bytes);
    const auto clips = RunAll(options);
    ASSERT_EQ(clips.size(), 1u);
    EXPECT_EQ(clips[0].outcome.summary.at("frames"), 13);
    EXPECT_THAT(ErrorCodes(clips[0].outcome), Contains("cut_off"));
    for (const std::optional<SourceOptions>& source : {std::optional(options.source), std::optional<SourceOptions>()}) {
      const Json inspection = InspectPath(options.path, source);
      ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.at("findings").dump(1);
      EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), 13);
      EXPECT_THAT(Codes(inspection, "error"), Contains("cut_off")) << source.has_value();
    }
  }
}

TEST_F(CutTables, AHeaderIsPassedOverByBothDeclaredOrNot) {
  IngestOptions options = Declared("kard");
  const std::string text = *ReadFile(options.path / "a01_s01_e01_realworld.txt");
  options.path = FreshFolder("table_header");
  int frames = 0;
  for (const std::string header : {"", "x y z\n", "# frame x y z\n", "a recording\nx,y,z\n"}) {
    Put(options.path / "a01_s01_e01_realworld.txt", header + text);
    const auto clips = RunAll(options);
    ASSERT_EQ(clips.size(), 1u);
    EXPECT_EQ(clips[0].outcome.kind, OutcomeKind::kDone);
    if (header.empty()) frames = clips[0].outcome.summary.at("frames");
    EXPECT_EQ(clips[0].outcome.summary.at("frames"), frames) << header;
    for (const std::optional<SourceOptions>& source : {std::optional(options.source), std::optional<SourceOptions>()}) {
      for (const fs::path& path : {options.path, options.path / "a01_s01_e01_realworld.txt"}) {
        const Json inspection = InspectPath(path, source);
        ASSERT_EQ(inspection.at("clips").size(), 1u) << header << inspection.at("findings").dump(1);
        EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), frames) << header;
        EXPECT_EQ(Value(inspection.at("clips")[0], "joints"), 15) << header;
        EXPECT_EQ(Codes(inspection, "error").size(), 0u) << header << inspection.at("findings").dump(1);
        EXPECT_EQ(Codes(inspection, "info").size(), header.empty() ? 0u : header[0] == 'a' ? 2u : 1u) << header;
      }
    }
  }
}

TEST_F(CutTables, APersonOfAmassWhoStandsStillTellsAPathInCentimetresByTheHeight) {
  const fs::path folder = FreshFolder("amass_stands");
  Npz archive = *ParseNpz(*ReadFile(fs::path(TestData()) / "amass_babel/amass_sample.npz"), "a");
  for (const double factor : {1.0, 100.0}) {
    Npz scaled = archive;
    for (NpzMember& member : scaled.members) {
      for (double& value : member.array.values) value *= member.name == "trans" ? factor : 1.0;
    }
    Put(folder / "walk_poses.npz", *EncodeNpz(scaled, "a"));
    const auto codes = Codes(InspectPath(folder / "walk_poses.npz", std::nullopt), "error");
    EXPECT_EQ(codes, factor == 1.0 ? std::vector<std::string>{} : std::vector<std::string>{"units_contradiction"});
  }
}

TEST_F(CutTables, NamesOfNtuThatSpeakOfMoreOrFewerPeopleThanThereAreAreToldByInspectionToo) {
  IngestOptions options = Declared("ntu");
  const std::string one = *ReadFile(options.path / "S001C001P001R001A011.skeleton");
  const std::string two = *ReadFile(options.path / "S001C003P008R002A058.skeleton");
  const auto find = [&](const std::string& name, const std::string& bytes, const char* code) {
    const fs::path folder = FreshFolder("ntu_people_told");
    Put(folder / name, bytes);
    const Json findings = Json(InspectPath(folder, options.source)).at("findings");
    return std::count_if(findings.begin(), findings.end(), [&](const Json& told) { return told.at("code") == code; });
  };
  EXPECT_EQ(find("S001C001P001R001A050.skeleton", one, "people_missing"), 1);
  EXPECT_EQ(find("S001C003P008R002A001.skeleton", two, "bodies_left_out"), 1);
  for (const char* code : {"people_missing", "bodies_left_out"}) {
    EXPECT_EQ(find("S001C001P001R001A011.skeleton", one, code), 0);
    EXPECT_EQ(find("S001C003P008R002A058.skeleton", two, code), 0);
  }
}

/// Findings of that code, of any severity.
int Tellings(const std::vector<ItemResult>& clips, const std::string& code) {
  int count = 0;
  for (const ItemResult& clip : clips) {
    for (const Finding& finding : clip.outcome.findings) count += finding.code == code ? 1 : 0;
  }
  return count;
}

TEST_F(CutTables, AJointOfNtuThatIsTrackedAtNoughtIsToldAndMissingInBoth) {
  IngestOptions options = Declared("ntu");
  NtuSkeleton skeleton = *ParseNtuSkeleton(*ReadFile(options.path / "S001C001P001R001A011.skeleton"), "a");
  for (std::size_t f = 20; f < 25; ++f) {
    NtuJoint& hand = skeleton.frames[f].at(0).joints[7];
    hand.x_m = hand.y_m = hand.z_m = 0.0;
    hand.tracking = 2;
  }
  options.path = FreshFolder("ntu_nought");
  Put(options.path / "S001C001P001R001A011.skeleton", WriteNtuSkeleton(skeleton));
  EXPECT_THAT(Codes(InspectPath(options.path, options.source), "warning"), Contains("zero_joint"));
  const auto clips = RunAll(options);
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(Tellings(clips, "zero_joint"), 1);
  for (const Finding& finding : clips[0].outcome.findings) {
    if (finding.code != "zero_joint") continue;
    EXPECT_EQ(finding.joint, "left_hand");
    EXPECT_EQ(finding.frame_begin, 20);
    EXPECT_EQ(finding.frame_end, 25);
    EXPECT_EQ(finding.action, FindingAction::kMissing);
  }
}

TEST_F(CutTables, AJointThatIsMissingInEveryFrameIsToldOnceByBoth) {
  IngestOptions options = Declared("msr_action3d");
  const std::string name = "a01_s03_e01_skeleton3D.txt";
  std::istringstream rows(*ReadFile(options.path / name));
  std::string row, altered;
  for (int i = 0; std::getline(rows, row); ++i) altered += (i % 20 == 7 ? "0 0 0 0" : row) + "\n";
  options.path = FreshFolder("msr_unseen");
  Put(options.path / name, altered);
  EXPECT_EQ(Tellings(RunAll(options), "joint_never_seen"), 1);
  const auto told = Codes(InspectPath(options.path, options.source), "info");
  EXPECT_EQ(std::count(told.begin(), told.end(), "joint_never_seen"), 1);
}

TEST_F(CutTables, ABodyOfAmassThatIsAKilometreFromItsMarkersIsATeleport) {
  const Npz archive = *ParseNpz(*ReadFile(fs::path(TestData()) / "amass_babel/amass_sample.npz"), "a");
  for (const bool markers : {true, false}) {
    Npz far;
    for (NpzMember member : archive.members) {
      if (!markers && member.name.rfind("marker", 0) == 0) continue;
      for (std::size_t f = 20; member.name == "trans" && f < 25; ++f) member.array.values[3 * f] += 1000.0;
      far.members.push_back(std::move(member));
    }
    const fs::path folder = FreshFolder("amass_far");
    Put(folder / "walk_poses.npz", *EncodeNpz(far, "a"));
    const Json inspection = InspectPath(folder / "walk_poses.npz", std::nullopt);
    std::vector<std::string> told;
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("code") == "teleport") told.push_back(finding.at("where"));
    }
    EXPECT_EQ(told, std::vector<std::string>{"walk_poses.npz frames 20-25"}) << markers << inspection.dump(1);
  }
}

class SameMotions : public RecordedFormats {};

TEST_F(SameMotions, CopiesInAFolderAreToldByInspectionAsByARun) {
  const fs::path folder = FreshFolder("copies");
  const fs::path data = fs::path(TestData()) / "bvh/bandai1";
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(data)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string first;
  for (const fs::path& file : files) {
    if (file.extension() != ".bvh" || !first.empty()) continue;
    first = *ReadFile(file);
  }
  Put(folder / "a.bvh", first);
  Put(folder / "b.bvh", first);
  const auto codes = Codes(InspectPath(folder, std::nullopt), "warning");
  EXPECT_THAT(codes, Contains("duplicate"));
}

TEST(Features, OfHumanMl3dAreNamedWithTheWayToJoints) {
  NpyArray array;
  array.shape = {20, 263};
  array.dtype = "<f4";
  array.values.assign(20 * 263, 0.5);
  const auto bytes = EncodeNpy(array, "a");
  ASSERT_TRUE(bytes);
  const fs::path folder = FreshFolder("features");
  Put(folder / "012314.npy", *bytes);
  const Json inspection = InspectPath(folder / "012314.npy", std::nullopt);
  EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr("features of HumanML3D"));
  EXPECT_THAT(inspection.at("findings")[0].at("message"), HasSubstr("recover_from_ric"));
}

}  // namespace
}  // namespace mocurate
