// `mocurate fit`: rotations for one file without a config, for motions that have none, and feet that stand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include <cstdlib>

#include "core/formats/c3d.h"
#include "core/formats/npy.h"
#include "core/motion/operations.h"
#include "core/store/store.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::Contains;
using ::testing::HasSubstr;

class FitVerbs : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    data_ = std::getenv("MOCURATE_DATA");
  }

  Result Fit(const fs::path& path, std::vector<std::string> more) {
    std::vector<std::string> words = {"fit", path.string(), "-o", output().string()};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(folder_, words, program::SharedCache());
  }
  /// The first frames of a BVH, in a file of the test.
  fs::path FirstFrames(const fs::path& bvh, int frames, const std::string& name) const {
    const std::string text = program::ReadText(bvh);
    const std::size_t header = text.find("Frames:"), time = text.find("Frame Time", header);
    std::size_t end = text.find('\n', time) + 1;
    std::string shortened = text.substr(0, header) + "Frames: " + std::to_string(frames) + "\n";
    for (int f = 0; f < frames; ++f) end = text.find('\n', end) + 1;
    WriteText(folder_ / name, shortened + text.substr(time, end - time));
    return folder_ / name;
  }
  fs::path output() const { return folder_ / "fitted.h5"; }
  Dataset Fitted() const {
    auto dataset = ReadDataset(output());
    EXPECT_TRUE(dataset.has_value()) << dataset.error().Message();
    return dataset ? *std::move(dataset) : Dataset();
  }
  fs::path kard() const { return data_ / "kinect/kard/a14_s02_e01_realworld.txt"; }

  ScratchFolder folder_;
  fs::path data_;
};

TEST_F(FitVerbs, AskWhatAnUnnamedColumnIs) {
  const fs::path msr = data_ / "kinect/msr_action3d/a01_s01_e01_skeleton3D.txt";
  const Result silent = Fit(msr, {"--set", "ingest.source.rate=15 Hz"});
  EXPECT_EQ(silent.exit_code, 2) << silent.err;
  EXPECT_THAT(silent.err, HasSubstr("ingest.source.columns"));
  const Result declared = Fit(msr, {"--set", "ingest.source.rate=15 Hz", "--set", "ingest.source.least_confidence=0.1",
                                    "--set", "ingest.source.columns=[x, y, z, confidence]"});
  EXPECT_EQ(declared.exit_code, 0) << declared.err;
  EXPECT_EQ(Fitted().clips.size(), 1u);
}

/// 22 joints of SMPL's 24, hips that hang from the pelvis, shoulders beside the neck: not where the skeleton's rest
/// pose has them. A false point does not affect the others.
TEST_F(FitVerbs, JointsOfAnotherBodyAreFollowedToMillimetres) {
  const fs::path sample = data_ / "humanact12/humanml3d_sample/012314_joints.npy";
  auto array = ParseNpy(program::ReadText(sample), "sample");
  ASSERT_TRUE(array) << array.error().Message();
  const NpyArray whole = *array;
  array->values[(50 * 22 + 20) * 3] = std::nan("");
  WriteText(folder_ / "hole.npy", WriteNpy(*array));
  for (const fs::path& path : {sample, folder_ / "hole.npy"}) {
    const Result result = Fit(path, {"--skeleton", "smpl24", "--set", "ingest.source.rate=20 Hz", "--force", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_LT(result.Json()["clips"][0]["fit"]["residual_rms_mm"].get<double>(), 5.0);
    const Motion motion = *Fitted().clips.at(0).motion;
    for (int f = 0; f < 170; ++f) {
      for (int j = 0; j < 22; ++j) {
        const Eigen::Map<const Vector3d> truth(whole.values.data() + (f * 22 + j) * 3);
        EXPECT_LT((motion.joints.at(f, j) - truth).norm(), 0.05) << f << " " << j;
      }
      EXPECT_EQ(motion.state[static_cast<std::size_t>(f) * 24 + 22], JointState::kInferred)
          << "hands are not in the file";
    }
    if (path == sample) continue;
    EXPECT_EQ(motion.state[50 * 24 + 20], JointState::kInterpolated);
    EXPECT_EQ(motion.state[50 * 24 + 19], JointState::kObserved);
  }
}

/// Trees of several programs, which call an ankle a foot, a collar a shoulder, and begin the arms where the chest does:
/// what is in the file is where it was, none of it is assumed.
TEST_F(FitVerbs, MotionsOfOtherTreesKeepTheirAnatomy) {
  for (const char* file :
       {"olafhaag_walk01", "kevinxie4c_walk_mixed_orders", "omimo_AV_8Walk_HVHA", "olafhaag_test_freebvh_mixamo"}) {
    const Result result =
        Fit(FirstFrames(data_ / "bvh/misc" / (std::string(file) + ".bvh"), 60, std::string(file) + ".bvh"),
            {"--skeleton", "smpl24", "--json", "--force", "--set", "fitting.joint_tracks.uncertainty=false", "--set",
             "fitting.solver=banded"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_LT(result.Json()["clips"][0]["fit"]["residual_rms_mm"].get<double>(), 3.0) << file;
    const Motion motion = *Fitted().clips.at(0).motion;
    for (const char* joint : {"left_shoulder", "right_wrist", "left_ankle", "spine3", "head"}) {
      EXPECT_EQ(motion.state[*motion.skeleton->FindJoint(joint)], JointState::kObserved) << file << ": " << joint;
    }
  }
}

/// Exchanged names and a mirrored world look the same: the correction is reported.
TEST_F(FitVerbs, AMirroredWorldIsReported) {
  std::string text = program::ReadText(data_ / "bvh/misc/olafhaag_walk01.bvh");
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  };
  replace("Left", "L~"), replace("Right", "Left"), replace("L~", "Right");
  WriteText(folder_ / "exchanged.bvh", text);
  const Result mirrored = Fit(folder_ / "exchanged.bvh", {"--skeleton", "smpl24", "--json"});
  EXPECT_EQ(mirrored.exit_code, 0) << mirrored.err;
  EXPECT_EQ(mirrored.Json()["findings"][0]["code"], "axes_mirrored");
  EXPECT_THAT(mirrored.err, HasSubstr("--set ingest.source.axes='+x +y +z'"));
  const Result kept =
      Fit(folder_ / "exchanged.bvh", {"--skeleton", "smpl24", "--force", "--set", "ingest.source.axes=+x +y +z"});
  EXPECT_EQ(kept.exit_code, 1) << kept.err;
}

/// Names of one skeleton, another tree: the file's own tree is used.
TEST_F(FitVerbs, ATreeThatDiffersFromItsNamesakeIsFitted) {
  const Result result = Fit(FirstFrames(data_ / "cmu/asf_amc/01_01.bvh", 200, "01_01.bvh"),
                            {"--skeleton", "smpl24", "--json", "--set", "fitting.joint_tracks.uncertainty=false",
                             "--set", "fitting.solver=banded"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(result.Json()["clips"][0]["fit"]["residual_rms_mm"].get<double>(), 6.0);
}

TEST_F(FitVerbs, OneFileOfADeclaredSetGetsRotationsOnTheSkeletonAskedFor) {
  const Result result = Fit(kard(), {"--source", "kard", "--skeleton", "openni16", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Dataset dataset = Fitted();
  ASSERT_EQ(dataset.clips.size(), 1u);
  EXPECT_EQ(dataset.skeleton->name, "openni16");
  EXPECT_EQ(dataset.clips[0].identity.person, "s02");
  EXPECT_EQ(dataset.clips[0].label, "walk");
  EXPECT_FALSE(dataset.clips[0].motion->joints_only());
  const nlohmann::json fit = result.Json()["clips"][0]["fit"];
  EXPECT_GT(fit["before"]["bone_spread_mm"], 1.0);
  EXPECT_LT(fit["after"]["bone_spread_mm"], 1e-6);
  EXPECT_LT(fit["residual_rms_mm"], 40.0);
}

TEST_F(FitVerbs, AContradictedDeclarationIsReportedWithExitCode1) {
  std::istringstream lines(program::ReadText(kard()));
  std::ostringstream halved;
  double x = 0.0, y = 0.0, z = 0.0;
  while (lines >> x >> y >> z) halved << 0.45 * x << ' ' << 0.45 * y << ' ' << 0.45 * z << '\n';
  const fs::path file = folder_ / "a14_s02_e01_realworld.txt";
  WriteText(file, halved.str());
  const Result contradicting = Fit(file, {"--source", "kard", "--skeleton", "openni16"});
  EXPECT_EQ(contradicting.exit_code, 1) << contradicting.err;
  EXPECT_THAT(contradicting.out, HasSubstr("error: units_contradiction"));
  EXPECT_EQ(Fitted().clips.size(), 1u) << "written all the same";
  const Result json = Fit(file, {"--source", "kard", "--skeleton", "openni16", "--json", "--force"});
  const nlohmann::json answer = json.Json();
  bool found = false;
  for (const auto& finding : answer["clips"][0]["findings"])
    found = found || (finding["code"] == "units_contradiction" && finding["severity"] == "error");
  EXPECT_TRUE(found) << json.out;
}

TEST_F(FitVerbs, PointsOfATrackerThatAreNoJointsOfTheSkeletonAreNotExcluded) {
  const Result result = Fit(kard(), {"--source", "kard", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Fitted().skeleton->name, "smpl24");
  EXPECT_THAT(result.Json()["clips"][0]["findings"].dump(), Not(HasSubstr("joints_excluded")));
}

/// MSR-Action3D's tracker measures people anew in each recording, as its declaration states.
TEST_F(FitVerbs, ABodyIsOfAPersonOrOfARecording) {
  for (const char* name : {"a01_s02_e01_skeleton3D.txt", "a04_s02_e01_skeleton3D.txt"}) {
    fs::create_directories(folder_ / "clips");
    fs::copy_file(data_ / "kinect/msr_action3d" / name, folder_ / "clips" / name);
  }
  const std::vector<std::string> declared = {"--source", "msr_action3d", "--skeleton", "kinect20", "--force"};
  ASSERT_EQ(Fit(folder_ / "clips", declared).exit_code, 0);
  const Dataset own = Fitted();
  ASSERT_EQ(own.clips.size(), 2u);
  const int spine = *own.skeleton->FindJoint("spine");
  EXPECT_GT(std::abs(own.clips[0].motion->bone_length[spine] - own.clips[1].motion->bone_length[spine]), 0.05);
  std::vector<std::string> of_person = declared;
  of_person.insert(of_person.end(), {"--set", "proportions.body_of=person"});
  of_person.push_back("--json");
  const Result pooled = Fit(folder_ / "clips", of_person);
  ASSERT_EQ(pooled.exit_code, 0) << pooled.err;
  ASSERT_EQ(pooled.Json()["shared_bodies"].size(), 1u);
  EXPECT_EQ(pooled.Json()["shared_bodies"].begin().value(), 2);
  const Dataset shared = Fitted();
  ASSERT_EQ(shared.clips.size(), 2u);
  EXPECT_EQ(shared.clips[0].motion->bone_length, shared.clips[1].motion->bone_length);
}

TEST_F(FitVerbs, RecordingsOfNoPersonKnownAreBodiesOfTheirOwn) {
  const std::vector<std::string> smpl = {"--skeleton", "smpl24", "--force", "--json", "--set", "fitting.solver=banded"};
  const fs::path walk = data_ / "bvh/misc/olafhaag_walk01.bvh";
  FirstFrames(walk, 30, "walks/short.bvh"), FirstFrames(walk, 40, "walks/long.bvh");
  const Result own = Fit(folder_ / "walks", smpl);
  EXPECT_EQ(own.Json()["clips"].size(), 2u);
  EXPECT_TRUE(own.Json()["shared_bodies"].empty()) << own.Json()["shared_bodies"];
  std::vector<std::string> of_person = smpl;
  of_person.insert(of_person.end(), {"--set", "proportions.body_of=person"});
  const Result pooled = Fit(folder_ / "walks", of_person);
  ASSERT_EQ(pooled.Json()["shared_bodies"].size(), 1u);
  EXPECT_EQ(pooled.Json()["shared_bodies"].begin().value(), 2);
}

/// The recording is then called as the file, and all else of the declaration holds: units, axes, rate, skeleton.
TEST_F(FitVerbs, RenamedFilesOfASetAreFittedAsOfAnUnknownPerson) {
  struct Renamed {
    const char *file, *name, *source, *beside;
  };
  for (const Renamed& one : {Renamed{"ntu/S001C001P001R001A011.skeleton", "x.skeleton", "", ""},
                             Renamed{"ntu/S001C001P001R001A011.skeleton", "x.skeleton", "ntu", ""},
                             Renamed{"kinect/kard/a14_s02_e01_realworld.txt", "x.txt", "kard", ""},
                             Renamed{"kinect/msr_action3d/a01_s01_e01_skeleton3D.txt", "x.txt", "msr_action3d", ""},
                             Renamed{"kinect/utkinect/carry_s01_e01.txt", "x.txt", "utkinect", ""},
                             Renamed{"kinect/florence3d/a01_s1_id1.txt", "x.txt", "florence3d", ""},
                             Renamed{"hdm05/01/HDM_bd_depositFloorR_001_120.amc", "x.amc", "hdm05", "hdm05/HDM_bd.asf"},
                             Renamed{"bvh/bandai1/dataset-1_bye_feminine_001.bvh", "x.bvh", "bandai1", ""}}) {
    SCOPED_TRACE(std::string(one.file) + " " + one.source);
    const fs::path folder = folder_ / (std::string("of_") + one.source);
    fs::create_directories(folder);
    fs::copy_file(data_ / one.file, folder / one.name, fs::copy_options::overwrite_existing);
    if (*one.beside != 0) fs::copy_file(data_ / one.beside, folder / fs::path(one.beside).filename());
    std::vector<std::string> more = {"--skeleton", "smpl24", "--force", "--set", "fitting.solver=banded"};
    if (*one.source != 0) more.insert(more.end(), {"--source", one.source});
    const std::string named = *one.source != 0 ? one.source : "fit";
    const Result result = Fit(folder / one.name, more);
    ASSERT_NE(result.exit_code, 3) << result.err;
    EXPECT_THAT(result.err, HasSubstr(*one.source == 0   ? ""
                                      : *one.beside != 0 ? "its skeleton to be HDM_bd.asf"
                                                         : "neither who performs nor what"));
    const Dataset fitted = Fitted();
    ASSERT_EQ(fitted.clips.size(), 1u);
    EXPECT_THAT(fitted.clips[0].id(), ::testing::StartsWith(named + "/unknown/x#0-"));
    EXPECT_EQ(fitted.clips[0].label, "");
    if (*one.source != 0) {
      EXPECT_EQ(Fit(folder, more).exit_code, 3) << "no file is as the declaration says";
    }
    const JointPositions unnamed = Fitted().clips.at(0).motion->joints;
    if (*one.source == 0 || *one.beside != 0) continue;  // long, or of another source
    ASSERT_NE(Fit(data_ / one.file, more).exit_code, 3);
    const JointPositions own = Fitted().clips.at(0).motion->joints;
    ASSERT_EQ(own.frames, unnamed.frames);
    for (std::size_t i = 0; i < own.xyz.size(); ++i) {
      ASSERT_NEAR(own.xyz[i], unnamed.xyz[i], 1e-6) << i;
    }
  }
}

TEST_F(FitVerbs, APatternThatIsReportedForOneFileNeedsNoFields) {
  fs::copy_file(data_ / "ntu/S001C001P001R001A011.skeleton", folder_ / "x.skeleton");
  const Result result =
      Fit(folder_ / "x.skeleton", {"--skeleton", "smpl24", "--set", "ingest.source.files='{recording}.skeleton'"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Fitted().clips.at(0).identity.person, "unknown");
}

/// A run processes a set, and needs its file names.
TEST_F(FitVerbs, ARunOfRenamedFilesIsRefused) {
  fs::copy_file(kard(), folder_ / "x.txt");
  const Result result =
      RunProgram(folder_, {"run", std::string(kSourceFolder) + "/configs/kard.yaml", "--set",
                           "ingest.path=" + folder_.path().string(), "-o", (folder_ / "run").string()});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("no file matches the pattern"));
}

TEST_F(FitVerbs, JointsThatTheSkeletonLacksAreExcludedAndNamed) {
  const Result result = Fit(kard(), {"--source", "kard", "--skeleton", "ntu14", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.Json()["clips"][0]["findings"].dump(), HasSubstr("skeleton 'ntu14' has no torso"));
}

TEST_F(FitVerbs, UndeclaredValuesAreRequestedAllAtOnce) {
  const Result unknown = Fit(kard(), {});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("rate"));
  EXPECT_THAT(unknown.err, HasSubstr("--set ingest.source.rate='30 Hz'"));
  EXPECT_FALSE(fs::exists(output()));
  const Result declared = Fit(kard(), {"--set", "ingest.source.rate=30 Hz", "--set", "ingest.source.axes=+x +y -z"});
  EXPECT_EQ(declared.exit_code, 0) << declared.err;
}

TEST_F(FitVerbs, AMotionOfAnotherSkeletonIsFittedByItsOwnNamesOfJoints) {
  const fs::path bvh = data_ / "bvh/bandai2/dataset-2_walk_normal_001.bvh";
  const Result nothing = Fit(bvh, {});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("has rotations already"));
  const Result result = Fit(bvh, {"--skeleton", "smpl24", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Dataset dataset = Fitted();
  const Motion& motion = *dataset.clips[0].motion;
  // Bandai's Hand_L is the wrist, its Foot_L the ankle: both lie where a person has them.
  EXPECT_NEAR(motion.bone_length[*motion.skeleton->FindJoint("left_wrist")], 0.223, 0.01);
  EXPECT_NEAR(motion.bone_length[*motion.skeleton->FindJoint("left_ankle")], 0.410, 0.01);
  EXPECT_LT(result.Json()["clips"][0]["fit"]["residual_p95_mm"], 40.0);
}

TEST_F(FitVerbs, FootSlidingOfAGivenMotionIsRemovedAndTheRestIsUnchanged) {
  ASSERT_EQ(Fit(data_ / "bvh/bandai2/dataset-2_walk_normal_001.bvh", {"--skeleton", "smpl24"}).exit_code, 0);
  const Dataset before = Fitted();
  const fs::path given = folder_ / "given.h5";
  fs::rename(output(), given);
  const Result result = Fit(given, {"--contacts", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json contacts = result.Json()["clips"][0]["fit"]["contacts"];
  EXPECT_LT(contacts["sliding_after"], 0.7 * contacts["sliding_before"].get<double>());
  EXPECT_GT(contacts["largest_shift_mm"], 0.0);
  const Dataset after = Fitted();
  const int neck = *after.skeleton->FindJoint("neck");
  for (int f = 0; f < 100; f += 10) {
    EXPECT_LT((after.clips[0].motion->joints.at(f, neck) - before.clips[0].motion->joints.at(f, neck)).norm(), 1e-5);
  }
  EXPECT_EQ(after.clips[0].identity.recording, before.clips[0].identity.recording);
}

TEST_F(FitVerbs, ADamagedDatasetIsReportedByItsField) {
  ASSERT_EQ(Fit(data_ / "bvh/bandai2/dataset-2_walk_normal_001.bvh", {"--skeleton", "smpl24"}).exit_code, 0);
  const Dataset dataset = Fitted();
  const auto value = static_cast<float>(dataset.clips[0].motion->joints.xyz.back());
  const fs::path given = folder_ / "given.h5";
  fs::rename(output(), given);
  std::string bytes = program::ReadText(given);
  const std::size_t at = bytes.rfind(std::string(reinterpret_cast<const char*>(&value), sizeof value));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  WriteText(given, bytes);
  const Result result = Fit(given, {"--skeleton", "kinect20"});
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("/frames/"));
}

TEST_F(FitVerbs, ClipsOfADatasetKeepTheirIdentity) {
  ASSERT_EQ(Fit(data_ / "bvh/bandai2/dataset-2_walk_normal_001.bvh", {"--skeleton", "smpl24"}).exit_code, 0);
  Dataset dataset = Fitted();
  Clip whole = dataset.clips.at(0);
  whole.identity.source = "set";
  whole.identity.licence = "CC-BY-NC";
  whole.identity.session = "evening";
  whole.role = "test";
  dataset.clips.clear();
  for (const int begin : {0, 100}) {  // two spans of one recording
    auto span = Cut(whole, begin, begin + 60);
    ASSERT_TRUE(span.has_value()) << span.error().Message();
    dataset.clips.push_back(*span);
  }
  const fs::path given = folder_ / "given\xff.h5";
  ASSERT_TRUE(WriteDataset(dataset, given).has_value());
  fs::remove(output());
  const Result result = Fit(given, {"--contacts"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Dataset fitted = Fitted();
  ASSERT_EQ(fitted.clips.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(fitted.clips[i].id(), dataset.clips[i].id());
    EXPECT_EQ(fitted.clips[i].identity.licence, "CC-BY-NC");
    EXPECT_EQ(fitted.clips[i].identity.session, "evening");
    EXPECT_EQ(fitted.clips[i].role, "test");
  }
}

TEST_F(FitVerbs, OneClipOfAFileOfSeveralIsChosenByItsPlace) {
  const fs::path stack = data_ / "humanact12/a2m_generated/humanact12_tf/motion_joints500000.npy";
  const Result none = Fit(stack, {"--clip", "[400]", "--set", "ingest.source.rate=30 Hz"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("there is no clip '[400]' (it has motion_joints500000.npy[0], "));
  const Result result = Fit(stack, {"--clip", "[2]", "--set", "ingest.source.rate=30 Hz", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Dataset dataset = Fitted();
  ASSERT_EQ(dataset.clips.size(), 1u);
  EXPECT_THAT(dataset.clips[0].id(), HasSubstr("motion_joints500000.0002#"));
  EXPECT_FALSE(dataset.clips[0].motion->joints_only());
}

TEST_F(FitVerbs, AMotionFindsItsSkeletonFileWithinTheFolderThatIsGiven) {
  const std::string clip = "01/HDM_bd_depositFloorR_001_120.amc";
  EXPECT_EQ(Fit(data_ / "hdm05" / clip, {"--skeleton", "smpl24"}).exit_code, 2);
  const Result hdm = Fit(data_ / "hdm05", {"--skeleton", "smpl24", "--clip", clip});
  EXPECT_EQ(hdm.exit_code, 0) << hdm.err;
  EXPECT_EQ(Fitted().clips.size(), 1u);
}

TEST_F(FitVerbs, OutputsAreNotOverwrittenAndMissingInputIsRefused) {
  WriteText(output(), "mine");
  EXPECT_EQ(Fit(kard(), {"--source", "kard"}).exit_code, 2);
  EXPECT_EQ(program::ReadText(output()), "mine");
  EXPECT_EQ(Fit(kard(), {"--source", "kard", "--force"}).exit_code, 0);
  fs::remove(output());
  const Result missing = Fit(folder_ / "not_there.bvh", {});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.err, HasSubstr("no such file"));
  WriteText(folder_ / "broken.bvh", "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 x\n");
  EXPECT_EQ(Fit(folder_ / "broken.bvh", {"--skeleton", "smpl24"}).exit_code, 3);
  const Result source = Fit(kard(), {"--source", "card"});
  EXPECT_EQ(source.exit_code, 2);
  EXPECT_THAT(source.err, HasSubstr("did you mean"));
  EXPECT_FALSE(fs::exists(output()));
}

/// A walk of Plug-in Gait's 16 markers, whose program added joint centres, angles and moments as points.
TEST_F(FitVerbs, MarkersOfAWalkAreExplainedWithConstantBones) {
  WriteText(folder_ / "vicon.yaml",
            "include: markers/plug_in_gait.yaml\ningest:\n  source: {name: vicon, format: c3d, files: "
            "\"{recording}.c3d\", person: one, label: \"\", units: mm, axes: \"+x -z +y\"}\n");
  const Result fitted = Fit(data_ / "c3d_trc/PiG_Motion3_FF.c3d",
                            {"--source", (folder_ / "vicon.yaml").string(), "--skeleton", "smpl24"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  const Dataset dataset = Fitted();
  ASSERT_EQ(dataset.clips.size(), 1u);
  const Clip& clip = dataset.clips.front();
  EXPECT_EQ(clip.motion->frame_count(), 293);
  EXPECT_LT(clip.fit_rms, 0.006) << "metres, of the markers";
  // Plug-in Gait's knees (LFEO) and ankles (LTIO) in the middle frame, in metres.
  const auto c3d = ParseC3d(program::ReadText(data_ / "c3d_trc/PiG_Motion3_FF.c3d"), "walk");
  ASSERT_TRUE(c3d) << c3d.error().Message();
  for (const auto& [point, joint, most] : {std::tuple("LFEO", "left_knee", 0.02),
                                           {"RFEO", "right_knee", 0.02},
                                           {"LTIO", "left_ankle", 0.03},
                                           {"RTIO", "right_ankle", 0.03}}) {
    for (std::size_t p = 0; p < c3d->points.size(); ++p) {
      if (c3d->points[p].label != point) continue;
      const double* at = c3d->at(146, static_cast<int>(p));
      const Vector3d centre(1e-3 * at[0], 1e-3 * at[2], -1e-3 * at[1]);
      EXPECT_LT((Vector3d(clip.motion->joints.at(146, *clip.motion->skeleton->FindJoint(joint))) - centre).norm(), most)
          << point;
    }
  }
}

}  // namespace
}  // namespace mocurate
