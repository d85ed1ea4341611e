// `mocurate export`: motions of a store in the layouts of other programs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/formats/npz.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "tests/app/program.h"
#include "tests/support/swinging_clips.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using ::testing::HasSubstr;

class ExportVerbs : public ::testing::Test {
 protected:
  /// Two clips of a person who stands.
  void SetUp() override {
    Dataset dataset;
    auto skeleton = std::make_shared<Skeleton>();
    skeleton->name = "stick";
    skeleton->joints.resize(2);
    skeleton->joints[0].name = "pelvis";
    skeleton->joints[0].mirror = 0;
    skeleton->joints[1].name = "head";
    skeleton->joints[1].parent = 0;
    skeleton->joints[1].rest_offset = {0.0, 0.7, 0.0};
    skeleton->joints[1].mirror = 1;
    dataset.skeleton = skeleton;
    dataset.recipe = "test";
    dataset.created_by = "test";
    for (const char* recording : {"a/b", "c"}) {
      Clip clip;
      clip.identity = {"set", "anna", recording, "", "", "", 0, 3};
      clip.rate = FrameRate{30, 1};
      clip.motion =
          MakeMotion(dataset.skeleton, clip.rate, std::vector<Vector3d>(3, Vector3d(0, 0.9, 0)),
                     std::vector<Quaterniond>(6, Quaterniond::Identity()), dataset.skeleton->RestBoneLengths());
      clip.evidence_sha256 = std::string(64, '0');
      dataset.clips.push_back(std::move(clip));
    }
    const Status written = WriteDataset(dataset, folder_ / "motions.h5");
    ASSERT_TRUE(written.has_value()) << written.error().Message();
  }

  Result Export(std::vector<std::string> words) {
    words.insert(words.begin(), {"export", (folder_ / "motions.h5").string()});
    return RunProgram(folder_, words);
  }

  ScratchFolder folder_;
};

TEST_F(ExportVerbs, OneClipThatCannotBeWrittenCostsItself) {
  std::filesystem::create_directories(folder_ / "out/_/anna/c.csv/in the way");
  const Result result = Export({"--layout", "csv", "-o", (folder_ / "out").string(), "--force", "--json"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(result.Json()["files"].size(), 1u);
  EXPECT_TRUE(result.Json()["refused"].contains("set/anna/c#0-3")) << result.out;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/_/anna/a_b.csv"));
  EXPECT_THAT(ReadText(folder_ / "out/clips.csv"), ::testing::Not(HasSubstr("anna/c")));
}

TEST_F(ExportVerbs, WritesAFileForEachClip) {
  const Result result = Export({"-o", (folder_ / "arrays").string(), "--as", "axis_angle", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json answer = result.Json();
  ASSERT_EQ(answer["files"].size(), 2u);
  for (const nlohmann::json& file : answer["files"]) {
    const auto arrays = ParseNpz(ReadText(file["path"].get<std::string>()), "exported");
    ASSERT_TRUE(arrays.has_value()) << arrays.error().Message();
    ASSERT_NE(arrays->Find("poses"), nullptr);
    EXPECT_EQ(arrays->Find("poses")->shape, (std::vector<std::size_t>{3, 2, 3}));
    EXPECT_EQ(arrays->Find("clip")->texts.at(0), file["clip"]);
  }
}

TEST_F(ExportVerbs, OneFileHoldsOneClip) {
  const std::string file = (folder_ / "one.npz").string();
  const Result both = Export({"-o", file});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("--clip 'set/anna/a/b#0-3'"));
  EXPECT_EQ(Export({"-o", file, "--clip", "c#0-3"}).exit_code, 0);
  const Result again = Export({"-o", file, "--clip", "c#0-3"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("--force"));
  EXPECT_EQ(Export({"-o", file, "--clip", "c#0-3", "--force"}).exit_code, 0);
}

TEST_F(ExportVerbs, LinksBelowTheNamedFolderAreNotFollowed) {
  const std::string output = (folder_ / "named").string(), file = (folder_ / "link.npz").string();
  std::filesystem::create_directories(folder_ / "disk");
  std::filesystem::create_directory_symlink("disk", folder_ / "named");
  program::WriteText(folder_ / "victim.npz", "old");
  const Result first = Export({"-o", output, "--json"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const std::filesystem::path written = first.Json()["files"][0]["path"].get<std::string>();
  std::filesystem::remove(written);
  std::filesystem::create_symlink(folder_ / "victim.npz", written);
  EXPECT_EQ(Export({"-o", output, "--force"}).exit_code, 1) << "that clip alone";
  EXPECT_EQ(ReadText(folder_ / "victim.npz"), "old");
  std::filesystem::create_symlink("victim.npz", file);
  EXPECT_EQ(Export({"-o", file, "--clip", "c#0-3", "--force"}).exit_code, 0) << "the user named this one";
  EXPECT_NE(ReadText(folder_ / "victim.npz"), "old");
  EXPECT_TRUE(std::filesystem::is_symlink(file));
}

TEST_F(ExportVerbs, NamesUnknownClipsAndRepresentations) {
  const std::string output = (folder_ / "arrays").string();
  const Result clip = Export({"-o", output, "--clip", "d"});
  EXPECT_EQ(clip.exit_code, 2);
  EXPECT_THAT(clip.err, HasSubstr("no clip has the id 'd'"));
  EXPECT_EQ(Export({"-o", output, "--as", "euler"}).exit_code, 2);
  const Result none = RunProgram(folder_, {"export", (folder_ / "none.h5").string(), "-o", output});
  EXPECT_EQ(none.exit_code, 3);
}

/// Four clips of two persons with rotations, labels and splits.
class ExportLayouts : public ::testing::Test {
 protected:
  void SetUp() override { Store(dataset_); }

  void Store(const Dataset& dataset) {
    const Status written = WriteDataset(dataset, folder_ / "set.h5");
    ASSERT_TRUE(written.has_value()) << written.error().Message();
  }

  Result Export(const std::string& layout, const std::string& output, std::vector<std::string> more = {}) {
    more.insert(more.begin(),
                {"export", (folder_ / "set.h5").string(), "-o", (folder_ / output).string(), "--layout", layout});
    return RunProgram(folder_, more);
  }

  Dataset dataset_ = SwingingSet("smpl24");
  ScratchFolder folder_;
};

TEST_F(ExportLayouts, ComeBackAsADataset) {
  ASSERT_EQ(Export("bvh", "bvh").exit_code, 0);
  const Result run = RunProgram(
      folder_, {"run", (folder_ / "bvh/source.yaml").string(), "-o", (folder_ / "run").string(), "--to", "assemble"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto back = ReadDataset(folder_ / "run/dataset.h5");
  ASSERT_TRUE(back) << back.error().Message();
  EXPECT_EQ(back->labels, dataset_.labels);
  EXPECT_EQ(back->skeleton->name, "smpl24");
  ASSERT_EQ(back->clips.size(), 4u);
  double worst = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Motion &own = *dataset_.clips[i].motion, &read = *back->clips[i].motion;
    EXPECT_EQ(back->clips[i].label, dataset_.clips[i].label);
    ASSERT_EQ(read.frame_count(), own.frame_count());
    for (int f = 0; f < own.frame_count(); ++f) {
      for (int j = 0; j < 24; ++j) worst = std::max(worst, (read.joints.at(f, j) - own.joints.at(f, j)).norm());
    }
  }
  EXPECT_LT(worst, 1e-5);  // metres; the store keeps single precision
  const Split* persons = back->FindSplit("persons");
  ASSERT_NE(persons, nullptr);
  EXPECT_EQ(persons->train, (std::vector<int>{0, 1}));
  EXPECT_EQ(persons->test, (std::vector<int>{2, 3}));
  // And as files of any other program.
  const Result again = RunProgram(folder_, {"export", (folder_ / "bvh").string(), "--source",
                                            (folder_ / "bvh/source.yaml").string(), "-o", (folder_ / "npz").string()});
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(ExportLayouts, RefuseUnsupportedOptions) {
  EXPECT_EQ(Export("fbx", "x").exit_code, 2);
  EXPECT_EQ(Export("bvh", "x", {"--as", "quaternion"}).exit_code, 2);
  EXPECT_EQ(Export("csv", "x", {"--split", "none"}).exit_code, 2);
  EXPECT_EQ(Export("csv", "x.bvh").exit_code, 2) << "the ending of another layout";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x"));
  for (Clip& clip : dataset_.clips) clip.motion = MakeJointsOnly(dataset_.skeleton, clip.rate, clip.motion->joints);
  dataset_.joints_only = true;
  Store(dataset_);
  for (const char* layout : {"bvh", "actor", "amass_babel", "npz"}) EXPECT_EQ(Export(layout, "x").exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x"));
  EXPECT_EQ(Export("csv", "tables").exit_code, 0);
}

TEST_F(ExportLayouts, AClipThatCannotBeExportedDoesNotAffectOthers) {
  dataset_.clips[1].rate = dataset_.clips[1].motion->rate = FrameRate{60, 1};
  Store(dataset_);
  const Result result = Export("csv", "tables", {"--json"});
  EXPECT_EQ(result.exit_code, 1);
  const nlohmann::json answer = result.Json();
  EXPECT_EQ(answer["files"].size(), 3u);
  ASSERT_EQ(answer["refused"].size(), 1u);
  EXPECT_TRUE(answer["refused"].contains(dataset_.clips[1].id()));
  for (const nlohmann::json& file : answer["files"]) {
    EXPECT_TRUE(std::filesystem::exists(file["path"].get<std::string>()));
  }
}

TEST_F(ExportLayouts, OverwriteOnlyWithForce) {
  program::WriteText(folder_ / "out/notes.txt", "mine");
  EXPECT_EQ(Export("csv", "out").exit_code, 2);
  const Result forced = Export("csv", "out", {"--force", "--json"});
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_EQ(ReadText(folder_ / "out/notes.txt"), "mine");
  const std::size_t notes = forced.Json()["notes"].size();
  EXPECT_EQ(Export("csv", "alone", {"--json"}).Json()["notes"].size() + 1, notes) << "remaining files are reported";
}

TEST_F(ExportLayouts, WriteOneFileIfOneIsNamed) {
  const std::string clip = dataset_.clips[0].id();
  EXPECT_EQ(Export("bvh", "walk.bvh").exit_code, 2) << "four clips";
  EXPECT_EQ(Export("bvh", "walk.bvh", {"--clip", clip}).exit_code, 0);
  EXPECT_THAT(ReadText(folder_ / "walk.bvh"), HasSubstr("ROOT pelvis"));
  EXPECT_EQ(Export("bvh", "walk.bvh", {"--clip", clip}).exit_code, 2);
  EXPECT_EQ(Export("actor", "lists/humanact12poses.pkl").exit_code, 0) << "all clips";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "lists/humanact12poses.pkl"));
  const Result back = RunProgram(
      folder_, {"export", (folder_ / "lists").string(), "--source",
                (folder_ / "lists/humanact12poses.source.yaml").string(), "-o", (folder_ / "back").string(), "--json"});
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_EQ(back.Json()["files"].size(), 4u);
}

TEST(ExportVerb, ReadsAnyMotionFileAndNamesUnreadableOnes) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  const std::string walk = ReadText(std::filesystem::path(data) / "bvh/misc/olafhaag_walk01.bvh");
  program::WriteText(folder / "bvh/good.bvh", walk);
  const Result alone = RunProgram(folder, {"export", (folder / "bvh/good.bvh").string(), "-o",
                                           (folder / "one.npz").string(), "--as", "quaternion"});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const auto arrays = ParseNpz(ReadText(folder / "one.npz"), "exported");
  ASSERT_TRUE(arrays.has_value()) << arrays.error().Message();
  EXPECT_EQ(arrays->Find("joints")->shape.at(0), 101u) << "as many frames as the file declares";
  program::WriteText(folder / "bvh/truncated.bvh", walk.substr(0, walk.find("MOTION")));
  const Result both =
      RunProgram(folder, {"export", (folder / "bvh").string(), "-o", (folder / "all").string(), "--json"});
  EXPECT_EQ(both.exit_code, 1) << both.err;
  EXPECT_EQ(both.Json()["files"].size(), 1u);
  EXPECT_EQ(both.Json()["refused"].size(), 1u);
}

/// Height of the lower foot of smpl24 in the first frame, the median over the clips.
double MedianFootHeight(std::vector<double> heights) {
  if (heights.empty()) return 10.0;
  std::sort(heights.begin(), heights.end());
  return heights[heights.size() / 2];
}

/// A clip that a check excludes: what is tolerated keeps the other rules.
TEST(VerbsThatReadFiles, KeepTheGapRuleOfClipsThatAreTolerated) {
  const ScratchFolder folder;
  std::string rows;
  for (int f = 0; f < 120; ++f) {
    const bool lost = f >= 40 && f < 80;
    for (int j = 0; j < 15; ++j) {
      const double jump = f == 20 ? 900.0 : 0.0;
      rows += lost ? "0 0 0\n" : std::to_string(10 * j + f + jump) + " " + std::to_string(100 * j) + " 2000\n";
    }
  }
  program::WriteText(folder / "a.txt", rows);
  program::WriteText(
      folder / "source.yaml",
      "name: s\ningest:\n  source: {name: s, format: joint_table, files: '{recording}.txt', units: mm, axes: '+x +y "
      "+z', "
      "rate: 30 Hz, skeleton: openni15, missing: zero, joints: [head, neck, torso, left_shoulder, left_elbow, "
      "left_hand, "
      "right_shoulder, right_elbow, right_hand, left_hip, left_knee, left_foot, right_hip, right_knee, right_foot], "
      "person: p, label: '', max_missing: 0.2}\n");
  const std::vector<std::string> arguments = {"export", folder / "a.txt", "--source", folder / "source.yaml",
                                              "-o",     folder / "a.npz", "--as",     "joints"};
  std::vector<std::string> codes;  // what is tolerated, one after the other
  for (const char* next : {"not_joint_positions", "mostly_missing"}) {
    std::vector<std::string> more = arguments;
    more.insert(more.end(), codes.begin(), codes.end());
    const Result refused = RunProgram(folder, more);
    EXPECT_EQ(refused.exit_code, 3) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr(std::string("--tolerate ") + next));
    codes.insert(codes.end(), {"--tolerate", next});
  }
  std::vector<std::string> more = arguments;
  more.insert(more.end(), codes.begin(), codes.end());
  more.insert(more.end(), {"--json", "--inferred", "keep"});
  const Result tolerated = RunProgram(folder, more);
  ASSERT_EQ(tolerated.exit_code, 0) << tolerated.err;
  EXPECT_THAT(tolerated.Json()["findings"].dump(), HasSubstr("long_gap"));
}

/// What a run refuses, `export` and `draw` refuse too, or go on where the code is tolerated.
TEST(VerbsThatReadFiles, RefuseWhatARunRefusesUnlessItIsTolerated) {
  const ScratchFolder folder;
  std::string bvh =
      "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\nJOINT knee\n{\nOFFSET 0 -40 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 "
      "-40 0\n}\n}\n}\nMOTION\nFrames: 20\nFrame Time: 33.33\n";
  for (int f = 0; f < 20; ++f) bvh += std::to_string(f) + " 90 0 0 " + std::to_string(f) + " 0 0 5 0\n";
  program::WriteText(folder / "walk.bvh", bvh);
  program::WriteText(
      folder / "source.yaml",
      "name: walk\ningest:\n  source: {name: walk, format: bvh, files: '{recording}.bvh', units: cm, axes: "
      "'+x +y +z'}\n");
  const std::string file = folder / "walk.bvh", source = folder / "source.yaml";
  for (const std::vector<std::string>& verb : {std::vector<std::string>{"export", file, "-o", folder / "walk.npz"},
                                               {"draw", file, "-o", folder / "walk.svg"},
                                               {"view", file, "-o", folder / "walk.html"}}) {
    std::vector<std::string> arguments = verb;
    arguments.insert(arguments.end(), {"--source", source});
    const Result refused = RunProgram(folder, arguments);
    EXPECT_EQ(refused.exit_code, 3) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("--tolerate rate_implausible"));
    arguments.insert(arguments.end(), {"--tolerate", "rate_implausible"});
    const Result tolerated = RunProgram(folder, arguments);
    EXPECT_EQ(tolerated.exit_code, 0) << tolerated.err;
    EXPECT_TRUE(fs::exists(verb.back()));
    arguments.back() = "rate_implausibl";
    EXPECT_EQ(RunProgram(folder, arguments).exit_code, 2);
  }
}

TEST(View, WritesAPageOfFilesAndRunsAndRefusesOthers) {
  const ScratchFolder folder;
  const Dataset set = SwingingSet("smpl24");
  ASSERT_TRUE(WriteDataset(set, folder / "set.h5"));
  std::filesystem::create_directory(folder / "run");
  program::WriteText(folder / "run/run.json", "{}");
  const auto view = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "view");
    words.emplace_back("--json");
    return RunProgram(folder, words);
  };
  const std::string file = folder / "set.h5", run = folder / "run", page = folder / "page.html";
  EXPECT_EQ(view({run, "-o", page}).exit_code, 3) << "no dataset yet";
  ASSERT_TRUE(WriteDataset(set, folder / "run/dataset.h5"));
  const Result both = view({"raw=" + file, run, "-o", page});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_EQ(both.Json()["clips"], 2 * set.clips.size());
  EXPECT_EQ(both.Json()["sources"], 2);
  EXPECT_THAT(ReadFile(page).value_or(""), HasSubstr("\"name\":\"raw\""));
  EXPECT_EQ(view({file, "-o", page}).exit_code, 2) << "it is there";
  EXPECT_EQ(view({file, "-o", page, "--force", "--clip", set.clips[1].id()}).Json()["clips"], 1);
  EXPECT_EQ(view({file, "-o", page, "--force", "--clip", "unknown"}).exit_code, 3);
  EXPECT_EQ(view({file, "-o", folder / "page.svg"}).exit_code, 2);
  EXPECT_EQ(view({folder / "none.h5", "-o", page, "--force"}).exit_code, 3);
  EXPECT_EQ(view({file, "-o", page, "--force", "--body", file}).exit_code, 3) << "no body";
}

TEST(RunAndExport, PutFeetAtHeightZeroWhereTheFloorIsMeasuredAndSaySo) {
  const ScratchFolder folder;
  const auto succeeds = [&](const std::vector<std::string>& words) {
    const Result result = RunProgram(folder, words);
    EXPECT_EQ(result.exit_code, 0) << words[0] << ": " << result.err;
    return result;
  };
  for (const bool measured : {true, false}) {
    SCOPED_TRACE(measured);
    const std::string name = measured ? "floor" : "root";
    std::vector<std::string> job = program::SmallJob(folder, name);
    job.insert(job.end(), {"--set", "skeleton=smpl24"});
    if (measured) job.insert(job.end(), {"--set", "canon.level.rule=height", "--set", "canon.facing.height=measured"});
    succeeds(job);
    const std::string file = (folder / name / "dataset.h5").string();
    const auto set = ReadDataset(file);
    ASSERT_TRUE(set) << set.error().Message();
    std::vector<double> feet;
    for (const Clip& clip : set->clips) {
      EXPECT_EQ(clip.provenance.at(kHeightOrigin), measured ? kOriginFloor : kOriginRoot);
      feet.push_back(std::min(clip.motion->joints.at(0, 10).y(), clip.motion->joints.at(0, 11).y()));
    }
    if (measured) {
      EXPECT_NEAR(MedianFootHeight(feet), 0.0, 0.02);
    } else {
      EXPECT_LT(MedianFootHeight(feet), -0.7);
    }
    EXPECT_EQ(succeeds({"inspect", file, "--json"}).Json()["about"]["origin"], measured ? "floor" : "root");

    const std::string amass = (folder / (name + "_amass")).string(), back = (folder / (name + "_back")).string();
    succeeds({"export", file, "-o", amass, "--layout", "amass_babel"});
    const nlohmann::json files =
        succeeds({"export", amass, "--source", amass + "/source.yaml", "-o", back, "--as", "joints", "--json"})
            .Json()["files"];
    EXPECT_EQ(files.size(), set->clips.size());
    feet.clear();
    for (const nlohmann::json& written : files) {
      const auto arrays = ParseNpz(ReadText(written["path"].get<std::string>()), "exported");
      ASSERT_TRUE(arrays.has_value()) << arrays.error().Message();
      const std::vector<double>& joints = arrays->Find("joints")->values;
      feet.push_back(std::min(joints.at(3 * 10 + 1), joints.at(3 * 11 + 1)));
    }
    EXPECT_NEAR(MedianFootHeight(feet), 0.0, 0.02);
  }
}

/// A walk that is fitted, written as joints and fitted again.
TEST(ExportedJoints, AreFittedAgainByTheFilesOwnDeclaration) {
  const ScratchFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  const auto succeeds = [&](const std::vector<std::string>& words) {
    const Result result = RunProgram(folder, words);
    EXPECT_EQ(result.exit_code, 0) << words[0] << ": " << result.err;
    return result;
  };
  succeeds({"synthesize", "--layout", "tracks", "-o", path("studio"), "--set", "subjects=1", "--set", "actions=[walk]",
            "--set", "tracker.outlier=0", "--set", "tracker.wander=2 mm"});
  succeeds({"fit", path("studio/tracks"), "--source", "studio_tracks", "-o", path("walk.h5"), "--skeleton", "smpl24"});
  succeeds({"export", path("walk.h5"), "-o", path("walk.npz"), "--as", "joints"});
  const nlohmann::json clip = succeeds({"inspect", path("walk.npz"), "--json"}).Json()["clips"].at(0);
  EXPECT_EQ(clip["skeleton"]["value"], "smpl24");
  EXPECT_EQ(clip["skeleton"]["from"], "declared");
  EXPECT_EQ(clip["rate_hz"]["value"], 30.0);
  EXPECT_EQ(clip["units"]["value"], "m");
  EXPECT_EQ(clip["axes"]["value"], "+x +y +z");
  succeeds({"fit", path("walk.npz"), "-o", path("again.h5"), "--skeleton", "smpl24"});
  const auto once = ReadDataset(folder / "walk.h5"), twice = ReadDataset(folder / "again.h5");
  ASSERT_TRUE(once && twice);
  const Motion &first = *once->clips.at(0).motion, &second = *twice->clips.at(0).motion;
  ASSERT_EQ(second.joints.xyz.size(), first.joints.xyz.size());
  EXPECT_EQ(second.rate, first.rate);
  double worst = 0.0;
  for (int f = 0; f < first.frame_count(); ++f) {
    for (int j = 0; j < first.joint_count(); ++j)
      worst = std::max(worst, (second.joints.at(f, j) - first.joints.at(f, j)).norm());
  }
  EXPECT_LT(worst, 0.02);  // metres
}

TEST(ExportedJoints, AnotherOrderThanTheFileNamesIsRefused) {
  const ScratchFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  ASSERT_EQ(RunProgram(folder, {"synthesize", "--layout", "tracks", "-o", path("studio"), "--set", "subjects=1",
                                "--set", "actions=[walk]"})
                .exit_code,
            0);
  ASSERT_EQ(RunProgram(folder, {"fit", path("studio/tracks"), "--source", "studio_tracks", "-o", path("walk.h5"),
                                "--skeleton", "smpl24"})
                .exit_code,
            0);
  ASSERT_EQ(RunProgram(folder, {"export", path("walk.h5"), "-o", path("walk.npz"), "--as", "joints"}).exit_code, 0);
  std::string joints = "[pelvis, right_hip, left_hip";
  const auto walk = ReadDataset(folder / "walk.h5");
  ASSERT_TRUE(walk) << walk.error().Message();
  for (int j = 3; j < 24; ++j) joints += ", " + walk->skeleton->joints[static_cast<std::size_t>(j)].name;
  const Result refused = RunProgram(folder, {"fit", path("walk.npz"), "-o", path("again.h5"), "--skeleton", "smpl24",
                                             "--set", "ingest.source.joints=" + joints + "]"});
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_THAT(refused.err, HasSubstr("'right_hip' where 'left_hip' is declared"));
}

}  // namespace
}  // namespace mocurate
