// A source of undeclared files: `config init` writes its declaration, `run` reads it; `doctor --source` lists missing
// files. `run` accepts the names of jobs, `--source` those of source declarations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>

#include "core/store/store.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;

class Declarations : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    data_ = std::getenv("MOCURATE_DATA");
  }

  /// Writes the declaration of some files of a recorded set, each at its place; returns the options to fill in.
  std::vector<std::string> Declare(const std::string& set, const std::vector<std::string>& files) {
    for (const std::string& file : files) {
      fs::create_directories((folder_ / set / file).parent_path());
      fs::copy_file(data_ / set / file, folder_ / set / file);
    }
    const Result result = RunProgram(
        folder_, {"config", "init", (folder_ / set).string(), "-o", (folder_ / "made.yaml").string(), "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    text_ = ReadText(folder_ / "made.yaml");
    EXPECT_EQ(result.Json()["declaration"], text_);
    return FillNames(result.Json()["unknown"]);
  }
  /// Fills in who performs what, which no file of these declares; the rest of `unknown`.
  std::vector<std::string> FillNames(std::vector<std::string> unknown) {
    const auto taken = [&](const std::string& key) {
      if (key != "person" && key != "label") return false;
      Fill(key, key == "label" ? "\"\"" : text_.find("{body}") == std::string::npos ? "p01" : "p{body}");
      return true;
    };
    unknown.erase(std::remove_if(unknown.begin(), unknown.end(), taken), unknown.end());
    return unknown;
  }
  void Fill(const std::string& key, const std::string& value) {
    const std::size_t at = text_.find("    " + key + ": ");
    ASSERT_NE(at, std::string::npos) << text_;
    const std::size_t begin = at + 6 + key.size();
    text_.replace(begin, text_.find('\n', begin) - begin, value);
    WriteText(folder_ / "made.yaml", text_);
  }
  Result Ingest() {
    return RunProgram(
        folder_, {"run", (folder_ / "made.yaml").string(), "-o", (folder_ / "r").string(), "--to", "ingest", "--json"});
  }
  /// Clips that were read, from the log of the run; nothing contradicts the declaration.
  int Kept() {
    int kept = 0;
    std::ifstream log(folder_ / "r/curation_log.jsonl");
    for (std::string line; std::getline(log, line);) {
      const nlohmann::json clip = nlohmann::json::parse(line);
      EXPECT_THAT(clip["findings"].dump(), Not(HasSubstr("contradiction"))) << clip.dump(1);
      kept += clip.contains("evidence_sha256") ? 1 : 0;
    }
    return kept;
  }

  ScratchFolder folder_;
  fs::path data_;
  std::string text_;
};

TEST_F(Declarations, Bandai2IsRunAsItIsWritten) {
  const std::vector<std::string> unknown = Declare(
      "bvh/bandai2", {"dataset-2_walk_normal_001.bvh", "dataset-2_walk_active_001.bvh", "dataset-2_run_normal_001.bvh",
                      "dataset-2_run_normal_002.bvh", "dataset-2_wave-both-hands_active_002.bvh"});
  EXPECT_THAT(unknown, IsEmpty());
  EXPECT_THAT(text_, HasSubstr("files: \"dataset-2_{part1}_{part2}_{part3}.bvh\""));
  EXPECT_THAT(text_, HasSubstr("units: \"cm\""));
  EXPECT_THAT(text_, HasSubstr("# measured: 5 of 5 clips agree"));
  EXPECT_THAT(text_, HasSubstr("axes: \"+x +y +z\""));
  EXPECT_THAT(text_, HasSubstr("rate: 30 Hz  # declared by the file: Frame Time"));
  EXPECT_THAT(text_, HasSubstr("skeleton: \"bandai22\""));
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 5);
}

/// Of motions that come with rotations: those of a known tree, of a tree of their own, and of SMPL's joints.
TEST_F(Declarations, RecordedRotationsAreKeptOnTheSkeletonOfTheirFiles) {
  struct Motions {
    const char* folder;
    std::vector<std::string> files;
    const char* skeleton;  ///< empty: the files' own tree
    int joints;
  };
  for (const Motions& motions :
       {Motions{"bvh/bandai2", {"dataset-2_walk_normal_001.bvh", "dataset-2_run_normal_001.bvh"}, "bandai22", 22},
        Motions{"bvh/misc", {"olafhaag_walk01.bvh"}, "", 19},
        Motions{"amass_babel", {"amass_sample.npz"}, "smpl24", 24}}) {
    SCOPED_TRACE(motions.folder);
    fs::remove(folder_ / "made.yaml");
    fs::remove_all(folder_ / "r");
    for (const std::string& option : Declare(motions.folder, motions.files)) {
      ASSERT_EQ(option, "axes") << "AMASS's, where its file does not show them";
      Fill("axes", "\"+x -z +y\"");
    }
    const std::string made = folder_ / "made.yaml";
    const nlohmann::json options = RunProgram(folder_, {"config", "show", made, "--json"}).Json();
    EXPECT_EQ(options["fitting"]["method"], "none");
    EXPECT_EQ(options["ingest"]["source"]["skeleton"], motions.skeleton);
    const Result run = RunProgram(folder_, {"run", made, "-o", folder_ / "r", "--to", "assemble", "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err << text_;
    EXPECT_EQ(run.Json()["kept"], motions.files.size());
    EXPECT_EQ(run.Json()["replaces_rotations"], 0);
    for (const nlohmann::json& stage : run.Json()["stages"]) EXPECT_NE(stage["stage"], "fitting");
    std::ifstream log(folder_ / "r/curation_log.jsonl");
    for (std::string line; std::getline(log, line);) {
      const nlohmann::json clip = nlohmann::json::parse(line);
      EXPECT_EQ(clip["motion_sha256"], clip["evidence_sha256"]) << "passed through unchanged";
    }
    const auto dataset = ReadDataset(folder_ / "r/dataset.h5");
    ASSERT_TRUE(dataset) << dataset.error().Message();
    EXPECT_FALSE(dataset->joints_only);
    EXPECT_EQ(dataset->skeleton->joint_count(), motions.joints);
    if (*motions.skeleton != 0) {
      EXPECT_EQ(dataset->skeleton->name, motions.skeleton);
    }
  }
}

/// In the result, the log and the page, and in the text of the run and of `inspect`.
TEST_F(Declarations, ARunReportsReplacedRotations) {
  Declare("bvh/bandai2", {"dataset-2_walk_normal_001.bvh"});
  std::vector<std::string> job = {"run", folder_ / "made.yaml", "-o", folder_ / "r"};
  for (const char* assignment :
       {"fitting.method=joint_tracks", "fitting.other_joints=exclude", "fitting.joint_tracks.uncertainty=false",
        "fitting.solver=banded", "skeleton=smpl24", "report.videos=false"}) {
    job.insert(job.end(), {"--set", assignment});
  }
  const Result text = RunProgram(folder_, job);
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("fitting.method: none")) << "the way to keep them";
  EXPECT_THAT(ReadText(folder_ / "r/report/index.html"), HasSubstr("data-replaces-rotations=\"1\""));
  EXPECT_THAT(ReadText(folder_ / "r/curation_log.jsonl"), HasSubstr("\"replaces_rotations\":true"));
  const Result described = RunProgram(folder_, {"inspect", folder_ / "r", "--json"});
  EXPECT_EQ(described.Json()["replaces_rotations"], 1);
  job.emplace_back("--json");
  EXPECT_EQ(RunProgram(folder_, job).Json()["replaces_rotations"], 1);
}

TEST_F(Declarations, KardOnlyLacksItsRateAndIsRefusedUntilItIsFilledIn) {
  const std::vector<std::string> unknown =
      Declare("kinect/kard", {"a17_s01_e01_realworld.txt", "a17_s02_e01_realworld.txt", "a18_s01_e02_realworld.txt",
                              "a12_s03_e01_realworld.txt", "a01_s01_e01_realworld.txt"});
  EXPECT_THAT(unknown, ElementsAre("rate"));
  EXPECT_THAT(text_, HasSubstr("files: \"a{part1}_s{part2}_e{part3}_realworld.txt\""));
  EXPECT_THAT(text_, HasSubstr("axes: \"+x +y -z\""));
  EXPECT_THAT(text_, HasSubstr("units: \"mm\""));
  EXPECT_THAT(text_, HasSubstr("skeleton: \"openni15\""));
  const Result refused = Ingest();
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("rate"));
  EXPECT_THAT(refused.err, HasSubstr("FILL_IN"));
  EXPECT_THAT(refused.err, HasSubstr("ingest.source.rate"));
  EXPECT_THAT(refused.err, HasSubstr("write a number in Hz without quotes, e.g. `rate: 30 Hz`"));
  Fill("rate", "30 Hz");
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 5);
}

TEST_F(Declarations, Florence3DsClipsHaveNumbersOfTheirOwn) {
  const std::vector<std::string> unknown =
      Declare("kinect/florence3d",
              {"a06_s1_id18.txt", "a06_s1_id19.txt", "a07_s1_id20.txt", "a07_s1_id21.txt", "a01_s1_id1.txt"});
  EXPECT_THAT(unknown, ElementsAre("rate"));
  EXPECT_THAT(text_, HasSubstr("files: \"a{part1}_s1_id{part2}.txt\""));
  EXPECT_THAT(text_, HasSubstr("\nskeleton: openni16\n")) << "the usual one has no torso";
  Fill("rate", "15 Hz");
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 5);
  const Result whole = RunProgram(
      folder_, {"run", (folder_ / "made.yaml").string(), "-o", (folder_ / "r").string(), "--to", "assemble", "--json"});
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_EQ(whole.Json()["failed"], 0) << whole.out;
}

TEST_F(Declarations, ArraysOfTheUsualSkeletonNeedNoOther) {
  Declare("humanact12/a2m_generated", {"humanact12_tf/motion_joints500000.npy"});
  EXPECT_THAT(text_, Not(HasSubstr("\nskeleton:")));
}

TEST_F(Declarations, NtusNamesAndPeopleAreKnownByTheFormat) {
  const std::vector<std::string> unknown =
      Declare("ntu", {"S001C001P001R001A011.skeleton", "S001C003P008R002A058.skeleton", "S002C001P003R001A003.skeleton",
                      "S004C002P003R001A017.skeleton"});
  EXPECT_TRUE(unknown.empty());
  EXPECT_THAT(text_, HasSubstr("rate: 30 Hz"));
  EXPECT_THAT(text_, HasSubstr("bodies: {A058: 2}"));
  EXPECT_THAT(text_, HasSubstr("\nskeleton: ntu25\n"));
  EXPECT_THAT(text_, HasSubstr("axes: \"-x +y -z\""));
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 5);
}

TEST_F(Declarations, CmusMotionsFindTheirSkeletons) {
  const std::vector<std::string> unknown = Declare("cmu/asf_amc", {"01.asf", "01_01.amc", "12.asf", "02_01.amc"});
  EXPECT_THAT(unknown, ElementsAre("rate"));
  Fill("rate", "120 Hz");
  EXPECT_THAT(text_, HasSubstr("skeleton_files: \"{part1}.asf\""));
  EXPECT_THAT(text_, HasSubstr("person: \"{part1}\""));
  EXPECT_THAT(text_, HasSubstr("units: \"2.2222222222222 inch\""));
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 1) << "02_01.amc has no skeleton: " << run.err << text_;
  EXPECT_EQ(Kept(), 1);
}

TEST_F(Declarations, OneMotionAmongOthersHasItsOwnSkeletonByName) {
  Declare("cmu/acclaim_old", {"skel.amc", "skel.asf", "walk.amc", "walk.asf"});
  EXPECT_THAT(text_, HasSubstr("files: \"walk.amc\""));
  EXPECT_THAT(text_, HasSubstr("skeleton_files: \"walk.asf\""));
  EXPECT_THAT(text_, HasSubstr("e.g. skel.amc"));
  Fill("rate", "30 Hz");
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 1);
}

TEST_F(Declarations, OfMixedArraysThoseThatAreBodiesAreTheSource) {
  Declare("humanact12/a2m_generated", {"humanact12_lie/motion_joints30000.npy", "humanact12_tf/motion_joints500000.npy",
                                       "humanact12_tf/motion_class.npy"});
  EXPECT_THAT(text_, HasSubstr("files: \"humanact12_tf/motion_joints500000.npy\""));
  EXPECT_THAT(text_, HasSubstr("20 clips of format npy without joint positions"));
  Fill("rate", "20 Hz");
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 20);
}

TEST_F(Declarations, UndeclaredOptionsAreRefusedByNameOneAfterTheOther) {
  EXPECT_THAT(Declare("cmu/expmap", {"train/walking/walking_4.txt", "train/running/running_5.txt"}),
              ElementsAre("units", "axes", "rate", "skeleton", "joints"));
  Fill("rate", "120 Hz");
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"units", "m"},
                                   {"axes", "\"+x +y +z\""},
                                   {"skeleton", "cmu31"},
                                   {"joints", "[root]"}}) {
    const Result refused = Ingest();
    EXPECT_EQ(refused.exit_code, 2) << key;
    EXPECT_THAT(refused.err, HasSubstr("FILL_IN"));
    EXPECT_THAT(refused.err, HasSubstr("ingest.source." + key));
    Fill(key, value);
  }
  EXPECT_THAT(Ingest().err, Not(HasSubstr("FILL_IN")));
}

TEST_F(Declarations, NothingAboveTheFolderThatIsGivenIsRead) {
  const auto declare = [&](const char* folder) {
    const Result result = RunProgram(folder_, {"config", "init", (data_ / folder).string(), "-o",
                                               (folder_ / "made.yaml").string(), "--force", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    text_ = ReadText(folder_ / "made.yaml");
    return FillNames(result.Json()["unknown"]);
  };
  declare("cmu/asf_amc/01_01.amc");
  EXPECT_THAT(text_, HasSubstr("path: \"" + (data_ / "cmu/asf_amc/01_01.amc").string() + "\""));
  EXPECT_THAT(text_, HasSubstr("skeleton_files: \"01.asf\""));
  EXPECT_THAT(declare("hdm05/01"), Contains("skeleton_files"));
  EXPECT_THAT(declare("hdm05"), IsEmpty()) << text_;
  EXPECT_THAT(text_, HasSubstr("skeleton_files: \"HDM_{part2}.asf\""));
  EXPECT_THAT(text_, HasSubstr("person: \"{part2}\""));
  Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 33);
  EXPECT_THAT(declare("pose2sim/single"), IsSupersetOf({"calibration", "axes"}));
  EXPECT_THAT(declare("pose2sim"), ElementsAre("rate"));
  EXPECT_THAT(text_, HasSubstr("calibration: [Calib"));
}

TEST_F(Declarations, FoldersOfDepthImagesAreDeclaredWithTheirCamerasAndMasks) {
  const auto declare = [&](const char* folder) {
    const Result result = RunProgram(folder_, {"config", "init", (data_ / folder).string(), "-o",
                                               (folder_ / "made.yaml").string(), "--force", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    text_ = ReadText(folder_ / "made.yaml");
    EXPECT_THAT(FillNames(result.Json()["unknown"]), IsEmpty()) << text_;
  };
  declare("rgbd100");
  EXPECT_THAT(text_, HasSubstr("format: depth_views"));
  EXPECT_THAT(text_, HasSubstr("files: \"views/{camera}_depth.png\""));
  EXPECT_THAT(text_, HasSubstr("mask_files: \"views/{camera}_mask.jpg\""));
  EXPECT_THAT(text_, HasSubstr("calibration: [\"views/{camera}_camera.xml\"]"));
  EXPECT_THAT(text_, HasSubstr("camera_pose: camera_to_world"));
  Result run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 1);
  declare("clouds/rendered_seq");
  EXPECT_THAT(text_, HasSubstr("depth_files: \"depth/{view}_{frame:4}.png\""));
  fs::remove_all(folder_ / "r");
  run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 1);
  declare("clouds/rendered_body");
  EXPECT_THAT(text_, HasSubstr("depth_files: \"{part1}_{view:2}.png\"")) << "a clip's name has '_' in it too";
  fs::remove_all(folder_ / "r");
  run = Ingest();
  EXPECT_EQ(run.exit_code, 0) << run.err << text_;
  EXPECT_EQ(Kept(), 6);
}

TEST_F(Declarations, AWrongUnitIsReportedWithTheRightOne) {
  Declare("bvh/bandai2", {"dataset-2_walk_normal_001.bvh", "dataset-2_run_normal_001.bvh"});
  Fill("units", "m");
  const Result run = Ingest();
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const std::string log = ReadText(folder_ / "r/curation_log.jsonl");
  EXPECT_THAT(log, HasSubstr("in the declared unit 'm' the person measures 1"));
  EXPECT_THAT(log, HasSubstr("units: cm"));
  EXPECT_THAT(log, Not(HasSubstr("rest offset")));
}

TEST_F(Declarations, AnExistingFileIsOnlyOverwrittenWithForce) {
  const ScratchFolder folder;
  WriteText(folder / "mine.yaml", "name: mine\n");
  const std::string data = (data_ / "ntu").string();
  const std::string mine = (folder / "mine.yaml").string();
  const Result kept = RunProgram(folder, {"config", "init", data, "-o", mine});
  EXPECT_EQ(kept.exit_code, 2);
  EXPECT_THAT(kept.err, HasSubstr("--force"));
  EXPECT_EQ(ReadText(folder / "mine.yaml"), "name: mine\n");
  EXPECT_EQ(RunProgram(folder, {"config", "init", data, "-o", mine, "--force"}).exit_code, 0);
  EXPECT_THAT(ReadText(folder / "mine.yaml"), HasSubstr("format: ntu_skeleton"));
  const Result shown = RunProgram(folder, {"config", "init", data});
  EXPECT_EQ(shown.exit_code, 0);
  EXPECT_EQ(shown.out, ReadText(folder / "mine.yaml"));
}

TEST(DeclarationsOfNothing, AFolderWithoutMotionIsReported) {
  const ScratchFolder folder;
  WriteText(folder / "data/note.txt", "nothing here\n");
  const Result result = RunProgram(folder, {"config", "init", (folder / "data").string()});
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("no file holds motion"));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST(DoctorOfASource, NamesMissingFilesFolderAndLicence) {
  const ScratchFolder folder;
  WriteText(folder / "uestc/info/names.txt", "a00_d0_p001_c1_color.avi\n");
  const Result some =
      RunProgram(folder, {"doctor", "--source", "uestc", "--path", (folder / "uestc").string(), "--json"});
  EXPECT_EQ(some.exit_code, 4);
  const nlohmann::json document = some.Json();
  EXPECT_EQ(document["licence"], "research only");
  EXPECT_THAT(document["obtain"].get<std::string>(), HasSubstr("DATASETS.md"));
  EXPECT_EQ(document["path"], (folder / "uestc").string());
  std::map<std::string, int> found;
  for (const auto& file : document["files"]) found[file["pattern"]] = file["found"];
  EXPECT_EQ(found, (std::map<std::string, int>{{"vibe_cache_refined.pkl", 0},
                                               {"info/names.txt", 1},
                                               {"info/num_frames_min.txt", 0},
                                               {"info/action_classes.txt", 0}}));
  const Result text = RunProgram(folder, {"doctor", "--source", "uestc", "--path", (folder / "uestc").string()});
  EXPECT_THAT(text.out, HasSubstr("MISSING  vibe_cache_refined.pkl: VIBE's tracks"));
  EXPECT_THAT(text.err, HasSubstr("3 of 4 kinds of files are missing"));
}

TEST(DoctorOfASource, NamesTheFolderOfFilesOneLevelTooHighOrTooDeep) {
  const ScratchFolder folder;
  WriteText(folder / "set/kard/a01_s01_e01_realworld.txt", "1 2 3\n");
  const Result deeper = RunProgram(folder, {"doctor", "--source", "kard", "--path", (folder / "set").string()});
  EXPECT_EQ(deeper.exit_code, 4);
  EXPECT_THAT(deeper.out, HasSubstr("1 such file below " + (folder / "set/kard").string()));
  EXPECT_THAT(deeper.err, HasSubstr("name that folder"));
  WriteText(folder / "phspd/pose/subject03_group2_time4/pose.txt", "1\n");
  const Result higher = RunProgram(folder, {"doctor", "--source", "phspd", "--path", (folder / "phspd/pose").string()});
  EXPECT_THAT(higher.out, HasSubstr("such file below " + (folder / "phspd").string()));
}

TEST(DoctorOfASource, OfACaptureThatTheProgramMakesNothingIsMissing) {
  const ScratchFolder folder;
  const Result result = RunProgram(folder, {"doctor", "--source", "studio"});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("folder   none: the program generates the files"));
  EXPECT_THAT(result.out, Not(HasSubstr("MISSING")));
}

TEST(DoctorOfASource, ReportsFilesWithTheEndingAndAnotherName) {
  const ScratchFolder folder;
  WriteText(folder / "ntu/S001C001P001R001A001.skeleton", "0\n");
  WriteText(folder / "ntu/mine.skeleton", "0\n");
  const Result result = RunProgram(folder, {"doctor", "--source", "ntu", "--path", (folder / "ntu").string()});
  EXPECT_THAT(result.out, HasSubstr("1 file with this ending and another name, e.g. mine.skeleton"));
}

TEST(DoctorOfASource, KnowsEveryDeclarationAndItsOrigin) {
  const ScratchFolder folder;
  for (const auto& entry : fs::directory_iterator(fs::path(kSourceFolder) / "configs/sources")) {
    const std::string name = entry.path().stem().string();
    const Result result =
        RunProgram(folder, {"doctor", "--source", name, "--path", (folder / "nowhere").string(), "--json"});
    EXPECT_EQ(result.exit_code, 4) << name << result.err;
    EXPECT_FALSE(result.Json()["obtain"].get<std::string>().empty()) << name;
    EXPECT_FALSE(result.Json()["licence"].get<std::string>().empty()) << name;
    EXPECT_FALSE(result.Json()["files"].empty()) << name;
  }
  const Result unknown = RunProgram(folder, {"doctor", "--source", "kardd"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'kard'?"));
}

TEST(DoctorOfASource, AcceptsACompleteFolder) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  const Result result = RunProgram(folder, {"doctor", "--source", "kard"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("(432 files)"));
}

/// Starts the program in the folder of the test.
Result RunThere(const ScratchFolder& folder, const std::vector<std::string>& arguments) {
  program::Surroundings there;
  there.before_start = [&folder] { std::filesystem::current_path(folder.path()); };
  return RunProgram(folder, arguments, there);
}

TEST(SourceNames, AreThoseOfConfigsWhateverLiesInTheFolder) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "kard");
  WriteText(folder / "kard/notes.txt", "nothing");
  WriteText(folder / "florence3d", "nothing");
  for (const char* name : {"kard", "florence3d"}) {
    const Result inspected = RunThere(folder, {"inspect", "kard", "--source", name, "--json"});
    EXPECT_THAT(inspected.err, ::testing::Not(HasSubstr("config"))) << inspected.err;
    EXPECT_EQ(inspected.Json().at("path"), "kard");
    const Result doctor = RunThere(folder, {"doctor", "--source", name});
    EXPECT_THAT(doctor.out + doctor.err, HasSubstr(name));
    EXPECT_NE(doctor.exit_code, 2) << doctor.err;
    const Result run = RunThere(folder, {"run", name, "--set", "ingest.path=kard", "--dry-run"});
    EXPECT_NE(run.exit_code, 2) << run.err;
  }
  const Result path = RunThere(folder, {"inspect", "kard", "--source", "./kard"});
  EXPECT_EQ(path.exit_code, 2) << path.err;
  EXPECT_THAT(path.err, HasSubstr("./kard: is a folder, not a config file"));
}

/// `config show` of a name or a file, with captures in /data.
Result ShownConfig(const ScratchFolder& folder, const std::string& config) {
  program::Surroundings data;
  data.before_start = [] { setenv("MOCURATE_DATA", "/data", 1); };
  return RunProgram(folder, {"config", "show", config, "--json", "--set", "ingest.path=/data/captures"}, data);
}

TEST(JobNames, MeanTheFilesOfThatNameInConfigs) {
  const ScratchFolder folder;
  const fs::path configs = fs::path(kSourceFolder) / "configs";
  for (const char* below : {"", "reannotate/"}) {
    for (const auto& entry : fs::directory_iterator(configs / below)) {
      if (entry.path().extension() != ".yaml") continue;
      const std::string name = below + entry.path().stem().string();
      const Result named = ShownConfig(folder, name), file = ShownConfig(folder, entry.path().string());
      EXPECT_EQ(named.exit_code, file.exit_code) << name << named.err;
      EXPECT_EQ(named.Json(), file.Json()) << name;
    }
  }
  EXPECT_EQ(ShownConfig(folder, "kard").Json()["train"]["networks"].size(), 4u)
      << "the job, not the source declaration";
  EXPECT_TRUE(ShownConfig(folder, "reannotate/kard").Json()["train"]["networks"].empty());
}

TEST(JobNames, ThatNoJobHasAreWrongConfigWithTheNearestJob) {
  const ScratchFolder folder;
  for (const auto& [name, meant] : {std::pair<std::string, std::string>{"kardd", "'kard'"},
                                    {"sources/kard", "'kard'"},
                                    {"ntu", "'reannotate/ntu'"},
                                    {"hdm05", "--source hdm05"},
                                    {"skeletons/smpl24", "bandai2, "},
                                    {"nothing_like_it", "reannotate/kard, "}}) {
    for (const std::vector<std::string>& verb : {std::vector<std::string>{"run"}, {"config", "show"}}) {
      std::vector<std::string> arguments = verb;
      arguments.insert(arguments.end(), {name, "--json"});
      const Result result = RunProgram(folder, arguments);
      EXPECT_EQ(result.exit_code, 2) << name;
      const nlohmann::json error = result.Json()["error"];
      EXPECT_EQ(error["code"], "config") << name;
      EXPECT_EQ(error["where"], name);
      EXPECT_THAT(error["hint"].get<std::string>(), HasSubstr(meant)) << name;
    }
  }
}

TEST(JobNames, AreNoSourceDeclarations) {
  const ScratchFolder folder;
  WriteText(folder / "captures/note.txt", "nothing here\n");
  for (const char* verb : {"inspect", "fit"}) {
    std::vector<std::string> arguments = {verb, (folder / "captures").string(), "--source", "reannotate/kard"};
    if (std::string(verb) == "fit") arguments.insert(arguments.end(), {"-o", (folder / "fit.h5").string()});
    EXPECT_EQ(RunProgram(folder, arguments).exit_code, 2) << verb;
  }
  EXPECT_EQ(RunProgram(folder, {"doctor", "--source", "reannotate/kard"}).exit_code, 2);
}

}  // namespace
}  // namespace mocurate
