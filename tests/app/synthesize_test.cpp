// The studio writes the folder of a real set, and the job that reads the set runs on it unchanged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/disk.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::TightDisk;
using program::WriteText;
using ::testing::HasSubstr;

TEST(Synthesize, TheKardJobRunsOnAFolderOfKardsLayout) {
  const ScratchFolder folder;
  const std::string studio = (folder / "studio").string();
  const Result written = RunProgram(folder, {"synthesize", "--layout", "kard", "-o", studio, "--seed", "3", "--set",
                                             "actions=[walk, drink]", "--json"});
  ASSERT_EQ(written.exit_code, 0) << written.err;
  EXPECT_EQ(written.Json()["clips"], 4);
  EXPECT_TRUE(fs::exists(folder / "studio/kard/a14_s01_e01_realworld.txt"));
  EXPECT_TRUE(fs::exists(folder / "studio/truth/s01.h5"));
  const Result run = RunProgram(
      folder, {"run", std::string(kSourceFolder) + "/configs/kard_studio.yaml", "--set",
               "ingest.path=" + studio + "/kard", "--to", "assemble", "-o", (folder / "r").string(), "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.Json()["kept"], 4);
}

/// 30 mm of white noise, dropouts, gross errors, frames with exchanged sides.
std::vector<std::string> WithNoisyTracks(std::vector<std::string> words) {
  for (const char* error : {"noise=30 mm", "wander=0 mm", "dropout=0.05", "outlier=0.02", "swap=0", "swapped=0.02"})
    words.insert(words.end(), {"--set", std::string("tracker.") + error});
  return words;
}

TEST(Synthesize, NoisyTracksOfAllJointsAreFittedAndComparedWithTheTruthBesideThem) {
  const ScratchFolder folder;
  const std::string studio = (folder / "studio").string();
  const Result written =
      RunProgram(folder, WithNoisyTracks({"synthesize", "--layout", "tracks", "-o", studio, "--seed", "5", "--set",
                                          "subjects=1", "--set", "actions=[walk, boxing_right_left, sit]"}));
  ASSERT_EQ(written.exit_code, 0) << written.err;
  const std::vector<std::string> run = {"run",   std::string(kSourceFolder) + "/configs/reannotate/studio_tracks.yaml",
                                        "--set", "ingest.path=" + studio + "/tracks",
                                        "--to",  "fitting",
                                        "-o",    (folder / "r").string(),
                                        "--json"};
  std::vector<std::string> compared = run, nowhere = run;
  compared.insert(compared.end(), {"--set", "ingest.truth=" + studio + "/truth"});
  nowhere.insert(nowhere.end(), {"--set", "ingest.truth=" + studio + "/tracks"});
  const Result result = RunProgram(folder, compared);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto error = result.Json()["fit_error"];
  EXPECT_EQ(error["clips"], 3);
  EXPECT_GT(error["evidence_mm"], 27.0);  // 30 mm RMS are 27.6 on average, and some joints are grossly wrong
  EXPECT_LT(error["joint_mm"], 14.0);
  EXPECT_NEAR(error["within_one_sigma"].get<double>(), 0.683, 0.1);
  EXPECT_TRUE(RunProgram(folder, run).Json()["fit_error"].is_null());
  const Result refused = RunProgram(folder, nowhere);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("no truth file (.h5) is here"));
}

TEST(Synthesize, AnOptionUnusedByTheLayoutIsRefusedAndItsLayoutsAreNamed) {
  const ScratchFolder folder;
  const std::string out = (folder / "s").string();
  const Result noise = RunProgram(folder, {"synthesize", "--layout", "humanact12", "-o", out, "--set",
                                           "tracker.noise=4 mm", "--set", "depth.room=false"});
  EXPECT_EQ(noise.exit_code, 2);
  EXPECT_THAT(noise.err,
              HasSubstr("layout humanact12 does not use all given options: tracker.noise is of ntu, kard, uestc, "
                        "uestc_vibe, ntu_vibe, tracks; depth.room is of phspd"));
  EXPECT_FALSE(fs::exists(folder / "s"));
  WriteText(folder / "studio.yaml", "layout: humanact12\ntracker: {noise: 30 mm}\n");
  const Result file = RunProgram(folder, {"synthesize", (folder / "studio.yaml").string(), "-o", out});
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_THAT(file.err, HasSubstr("studio.yaml:2"));
  const Result clock = RunProgram(folder, {"synthesize", "--layout", "ntu", "--show", "--set", "rig.moved=5 cm"});
  EXPECT_EQ(clock.exit_code, 0) << clock.err;
  const Result ring = RunProgram(folder, {"synthesize", "--layout", "ntu", "--show", "--set", "rig.cameras=5"});
  EXPECT_EQ(ring.exit_code, 2);
}

TEST(Synthesize, ShownOptionsOfOneLayoutAreValidForAnother) {
  const ScratchFolder folder;
  WriteText(folder / "studio.yaml", RunProgram(folder, {"synthesize", "--layout", "kard", "--show"}).out);
  const Result shown =
      RunProgram(folder, {"synthesize", (folder / "studio.yaml").string(), "--layout", "openpose", "--show"});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
}

TEST(Synthesize, ASeedBeyond64BitsIsRefusedByItsName) {
  const ScratchFolder folder;
  for (const char* seed : {"18446744073709551616", "9223372036854775808", "-9223372036854775809"}) {
    const Result result =
        RunProgram(folder, {"synthesize", "-o", (folder / "studio").string(), "--seed", seed, "--show"});
    EXPECT_EQ(result.exit_code, 2) << result.out;
    EXPECT_THAT(result.err, HasSubstr(std::string("--seed: '") + seed + "'"));
  }
}

TEST(Synthesize, NamesTheDeclarationOfEachFolderWhichReadsIt) {
  const ScratchFolder folder;
  const std::vector<std::pair<std::string, std::string>> layouts = {
      {"humanact12", "[walk]"}, {"phspd", "[walk]"},        {"ntu", "[drink_water]"},
      {"kard", "[walk]"},       {"uestc", "[squatting]"},   {"uestc_vibe", "[squatting]"},
      {"ntu_vibe", "[throw]"},  {"tracks", "[walk]"},       {"openpose", "[walk]"},
      {"amass", "[]"},          {"rendered_seq", "[walk]"}, {"openpose_depth", "[walk]"},
      {"cmu8", "[walk]"}};
  for (const auto& [layout, actions] : layouts) {
    const std::string studio = (folder / layout).string();
    std::vector<std::string> words = {"synthesize", "--layout",          layout, "-o", studio, "--set", "subjects=1",
                                      "--set",      "actions=" + actions};
    const auto set = [&](const char* assignment) { words.insert(words.end(), {"--set", assignment}); };
    if (layout == "phspd" || layout == "ntu" || layout == "openpose_depth") set("depth.every=10000");
    if (layout == "openpose" || layout == "openpose_depth" || layout == "rendered_seq") {
      set("rig.width=96");
      set("rig.image_height=72");
    }
    const Result written = RunProgram(folder, words);
    ASSERT_EQ(written.exit_code, 0) << layout << written.err;
    std::size_t sources = 0;
    for (std::size_t at = written.out.find("inspect "); at != std::string::npos;
         at = written.out.find("inspect ", at + 1)) {
      const std::size_t path = at + 8, option = written.out.find(" --source ", path);
      const std::size_t end = written.out.find_first_of(",\n", option);
      const std::string source = written.out.substr(option + 10, end - option - 10);
      const Result doctor = RunProgram(
          folder, {"doctor", "--source", source, "--path", written.out.substr(path, option - path), "--json"});
      ASSERT_FALSE(doctor.Json()["files"].empty());
      EXPECT_GT(doctor.Json()["files"][0]["found"], 0) << layout << " " << source << doctor.out;
      ++sources;
    }
    EXPECT_GT(sources, 0u) << written.out;
  }
}

TEST(Synthesize, NamesAConfigToRunOnlyWhereThatIs) {
  const ScratchFolder folder;
  const fs::path installed = folder / "prefix/share/mocurate/configs/sources/kard.yaml";
  fs::create_directories(folder / "prefix/bin");
  fs::copy_file(fs::path(kBinaryFolder) / "mocurate", folder / "prefix/bin/mocurate");
  program::Surroundings elsewhere;
  elsewhere.program = folder / "prefix/bin/mocurate";
  elsewhere.before_start = [&] { fs::current_path(folder.path()); };
  for (const bool configs : {false, true}) {
    if (configs) WriteText(installed, ReadText(std::string(kSourceFolder) + "/configs/sources/kard.yaml"));
    const std::string studio = (folder / (configs ? "b" : "a")).string();
    const Result written = RunProgram(
        folder, {"synthesize", "--layout", "kard", "-o", studio, "--set", "actions=[walk]", "--set", "subjects=1"},
        elsewhere);
    ASSERT_EQ(written.exit_code, 0) << written.err;
    EXPECT_THAT(written.out, HasSubstr("mocurate inspect " + studio + "/kard --source kard"));
    EXPECT_EQ(written.out.find("mocurate run " + fs::canonical(folder.path()).string() +
                               "/prefix/share/mocurate/configs/sources/kard.yaml --set ingest.path=" + studio +
                               "/kard") != std::string::npos,
              configs)
        << written.out;
    EXPECT_EQ(written.out.find("mocurate run") != std::string::npos, configs) << written.out;
  }
}

TEST(Synthesize, OptionsComeFromAFileAndAreShown) {
  const ScratchFolder folder;
  WriteText(folder / "studio.yaml", "layout: ntu\nseed: 7\ndepth: {noise: 3 mm}\n");
  const Result shown =
      RunProgram(folder, {"synthesize", (folder / "studio.yaml").string(), "--set", "clips=2", "--show", "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_EQ(shown.Json()["layout"], "ntu");
  EXPECT_EQ(shown.Json()["seed"], 7);
  EXPECT_EQ(shown.Json()["clips"], 2);
  EXPECT_DOUBLE_EQ(shown.Json()["depth"]["noise"].get<double>(), 0.003);
}

TEST(Synthesize, AFolderWithoutSpaceIsRefusedBeforeAnythingIsWritten) {
  const ScratchFolder folder;
  TightDisk disk(folder / "small", 200000, 100000000);
  if (disk.Limit()) GTEST_SKIP() << "mounting is not permitted here";
  const Result refused =
      RunProgram(folder, {"synthesize", "--layout", "phspd", "-o", (disk.path() / "studio").string()});
  EXPECT_EQ(refused.exit_code, 74) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr(" GB in "));
  EXPECT_THAT(refused.err, HasSubstr(" are free"));
  EXPECT_FALSE(fs::exists(disk.path() / "studio"));
}

TEST(Synthesize, AnUnknownActionListsEachKnownOneOnce) {
  const ScratchFolder folder;
  const Result refused = RunProgram(
      folder, {"synthesize", "--layout", "humanact12", "-o", (folder / "s").string(), "--set", "actions=[qqqq]"});
  EXPECT_EQ(refused.exit_code, 2);
  const std::size_t first = refused.err.find("warm_up,");
  ASSERT_NE(first, std::string::npos) << refused.err;
  EXPECT_EQ(refused.err.find(" warm_up,", first + 1), std::string::npos) << refused.err;
}

TEST(Synthesize, WrongOptionsAreNamed) {
  const ScratchFolder folder;
  const Result layout = RunProgram(folder, {"synthesize", "--layout", "kardd", "-o", (folder / "s").string()});
  EXPECT_EQ(layout.exit_code, 2);
  EXPECT_THAT(layout.err, HasSubstr("kard"));
  const Result option = RunProgram(folder, {"synthesize", "--layout", "kard", "--set", "depth.noize=1 mm"});
  EXPECT_EQ(option.exit_code, 2);
  EXPECT_THAT(option.err, HasSubstr("noise"));
  const Result nowhere = RunProgram(folder, {"synthesize", "--layout", "kard"});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("-o"));
  fs::create_directories(folder / "full");
  WriteText(folder / "full/mine.txt", "mine");
  const Result full = RunProgram(folder, {"synthesize", "--layout", "kard", "-o", (folder / "full").string()});
  EXPECT_EQ(full.exit_code, 74);
  EXPECT_EQ(ReadText(folder / "full/mine.txt"), "mine");
  const Result body = RunProgram(folder, {"synthesize", "--layout", "kard", "-o", (folder / "b").string(), "--set",
                                          "body=" + (folder / "none.h5").string()});
  EXPECT_EQ(body.exit_code, 3);
  EXPECT_THAT(body.err, HasSubstr("none.h5"));
}

}  // namespace
}  // namespace mocurate
