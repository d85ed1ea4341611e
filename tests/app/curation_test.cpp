// Clips that are not kept: those that a rule of the config excludes are reported, and are no failures.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/base/sha256.h"
#include "core/base/text.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SharedCache;
using program::SmallJob;
using program::WriteText;
using ::testing::HasSubstr;

constexpr int kRowsPerFrame = 20;

/// A folder of captures with one clip of three frames, one empty file and one file that is no capture.
class Curated : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<std::string> first = SmallJob(folder_, "first");
    std::replace(first.begin(), first.end(), std::string("assemble"), std::string("ingest"));
    ASSERT_EQ(RunProgram(folder_, first, SharedCache()).exit_code, 0);
    capture_ = folder_ / "capture";
    fs::copy(folder_ / "first/capture", capture_);
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(capture_)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    count_ = static_cast<int>(files.size());
    ASSERT_GT(count_, 5);
    brief_ = files[2].stem();
    empty_ = files[4].stem();
    const std::string text = ReadText(files[2]);
    std::size_t end = 0;
    for (int row = 0; row < 3 * kRowsPerFrame; ++row) end = text.find('\n', end) + 1;
    WriteText(files[2], text.substr(0, end));
    WriteText(files[4], "");
    WriteText(capture_ / "notes.doc", "no capture");
  }

  Result Run(const std::vector<std::string>& assignments, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = SmallJob(folder_, "r");
    arguments.insert(arguments.end(),
                     {"--set", "ingest.synthetic.enabled=false", "--set", "ingest.path=" + capture_.string()});
    for (const std::string& assignment : assignments) arguments.insert(arguments.end(), {"--set", assignment});
    const auto to = std::find(arguments.begin(), arguments.end(), "--to");
    if (std::find(more.begin(), more.end(), "--to") != more.end()) arguments.erase(to, to + 2);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(folder_, arguments, SharedCache());
  }

  /// The line of the curation log whose clip holds `name`.
  nlohmann::json LogOf(const std::string& name) const {
    const std::string log = ReadText(folder_ / "r/curation_log.jsonl");
    for (const std::string_view line : SplitText(log, '\n')) {
      if (line.empty()) continue;
      nlohmann::json json = nlohmann::json::parse(line);
      if (json["clip"].get<std::string>().find(name) != std::string::npos) return json;
    }
    ADD_FAILURE() << name << " is not in the log";
    return {};
  }

  ScratchFolder folder_;
  fs::path capture_;
  std::string brief_, empty_;
  int count_ = 0;
};

TEST_F(Curated, OnlyBadInputCountsAsFailure) {
  const Result strict = Run({}, {"--json"});
  EXPECT_EQ(strict.exit_code, 1) << strict.err;
  EXPECT_THAT(strict.err, HasSubstr("1 of " + std::to_string(count_ - 1) + " clips failed (" +
                                    std::to_string(count_ + 1) + " less 2 excluded by rule)"));
  const nlohmann::json document = strict.Json();
  EXPECT_EQ(document["clips"], count_ + 1);
  EXPECT_EQ(document["kept"], count_ - 2);
  EXPECT_EQ(document["excluded"], 2);
  EXPECT_EQ(document["failed"], 1);

  fs::remove(capture_ / (empty_ + ".txt"));
  const Result sound = Run({});
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
  EXPECT_THAT(sound.out, HasSubstr("excluded by rule: 2, 0 failed"));
}

TEST_F(Curated, ARunThatEndsBeforeTheDatasetCountsTheRestAsUndecided) {
  const Result early = Run({}, {"--to", "ingest"});
  EXPECT_EQ(early.exit_code, 1) << early.err;
  const std::string counts = std::to_string(count_ + 1) + " clips, 0 kept, excluded by rule: 1, 1 failed, " +
                             std::to_string(count_ - 1) + " undecided (the run ended before)";
  EXPECT_THAT(early.out, HasSubstr(counts));
  EXPECT_THAT(early.err, HasSubstr("curation_log.jsonl has the reason of each)")) << "there is no dataset";
  EXPECT_THAT(RunProgram(folder_, {"inspect", (folder_ / "r").string()}).out, HasSubstr(counts));
}

TEST_F(Curated, TheLogNamesTheRuleOrTheFailure) {
  Run({});
  EXPECT_EQ(LogOf(brief_)["decision"], "excluded");
  EXPECT_EQ(LogOf(brief_)["stage"], "canon");
  EXPECT_THAT(LogOf(brief_)["rule"], ::testing::AnyOf("too_short", "never_moves"));
  EXPECT_EQ(LogOf("notes.doc")["decision"], "excluded");
  EXPECT_EQ(LogOf("notes.doc")["rule"], "name_mismatch");
  const nlohmann::json failed = LogOf(empty_);
  EXPECT_EQ(failed["decision"], "dropped");
  EXPECT_EQ(failed["source_sha256"], Sha256Hex("")) << "what was read is known";
  EXPECT_FALSE(failed.contains("value")) << "no rule measured it";
}

TEST_F(Curated, TheLogHasTheLimitOfAContradictionAndTheHashOfAFileThatIsRefusedByItsName) {
  Run({"ingest.source.units=cm", "ingest.source.on_contradiction=refuse", "ingest.source.other_files=error"});
  const nlohmann::json far = LogOf("r01");
  EXPECT_EQ(far["decision"], "dropped");
  ASSERT_TRUE(far.contains("threshold")) << far;
  EXPECT_EQ(far["threshold"], 2.2425) << "metres from head to foot that a person has at most";
  EXPECT_GT(far["value"], far["threshold"]);
  EXPECT_EQ(LogOf("notes.doc")["decision"], "dropped");
  EXPECT_EQ(LogOf("notes.doc")["source_sha256"], Sha256Hex("no capture"));
}

TEST(ClipOfManyFiles, RefusedClipHasAHashOfAllItsFiles) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, {"synthesize", "--layout", "openpose", "-o", (folder / "studio").string(), "--set",
                                "subjects=1", "--set", "actions=[walk]"})
                .exit_code,
            0);
  std::vector<std::string> hashes;
  const auto run = [&](const std::string& content) {
    for (const auto& entry : fs::recursive_directory_iterator(folder / "studio/openpose")) {
      const bool frame = entry.path().parent_path().string().find("_json") != std::string::npos;
      if (frame) WriteText(entry.path(), content);
    }
    RunProgram(folder, {"run", std::string(kSourceFolder) + "/configs/sources/studio_keypoints.yaml", "--set",
                        "ingest.path=" + (folder / "studio/openpose").string(), "--to", "ingest", "-o",
                        (folder / "r").string()});
    const std::string log = ReadText(folder / "r/curation_log.jsonl");
    const auto line = nlohmann::json::parse(log.substr(0, log.find('\n')));
    EXPECT_EQ(line["decision"], "dropped") << line;
    hashes.push_back(line.value("source_sha256", std::string()));
  };
  run("no keypoints");
  run("nor these");
  EXPECT_EQ(hashes[0].size(), 64u);
  EXPECT_NE(hashes[0], hashes[1]);
}

TEST_F(Curated, AFolderNamedLikeAClipHasALine) {
  fs::remove(capture_ / (empty_ + ".txt"));
  fs::create_directory(capture_ / "wave_p09_r01.txt");
  for (const char* others : {"finding", "ignore"}) {
    const Result result = Run({std::string("ingest.source.other_files=") + others});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json line = LogOf("wave_p09_r01.txt");
    EXPECT_EQ(line["rule"], "folder_not_read");
    EXPECT_THAT(line["reason"].get<std::string>(), HasSubstr("names files, this is a folder"));
  }
}

TEST_F(Curated, FilesExcludedForOneReasonAreOneLineWithTheirNumber) {
  WriteText(capture_ / "more.doc", "no capture");
  WriteText(capture_ / "other.doc", "no capture");
  const Result result = Run({}, {"--to", "ingest"});
  EXPECT_THAT(result.err, HasSubstr("3 files excluded (name_mismatch; curation_log.jsonl lists them), the first: "));
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("other.doc")));
  EXPECT_EQ(LogOf("other.doc")["rule"], "name_mismatch");
}

TEST_F(Curated, ADescriptionOfOtherDataIsNotShown) {
  Run({}, {"--to", "ingest"});
  const std::string run = (folder_ / "r").string();
  EXPECT_THAT(RunProgram(folder_, {"inspect", run}).out, ::testing::Not(HasSubstr("A synthetic capture")));
  Run({"description=mine"}, {"--to", "ingest"});
  EXPECT_THAT(RunProgram(folder_, {"inspect", run}).out, HasSubstr("mine"));
}

TEST_F(Curated, AFileNameMayBeDeclaredAFailure) {
  fs::remove(capture_ / (empty_ + ".txt"));
  const Result result = Run({"ingest.source.other_files=error"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(LogOf("notes.doc")["decision"], "dropped");
}

TEST_F(Curated, ALinkThatLeadsNowhereIsAFailureOfThatFile) {
  fs::remove(capture_ / (empty_ + ".txt"));
  fs::create_symlink("nowhere.txt", capture_ / "wave_p09_r01.txt");
  const Result result = Run({});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(LogOf("wave_p09_r01")["decision"], "dropped");
  EXPECT_THAT(LogOf("wave_p09_r01")["reason"].get<std::string>(),
              HasSubstr("is a link to 'nowhere.txt', which does not exist"));
}

TEST_F(Curated, FilesOutsideThePatternAreCountedByFolder) {
  fs::remove(capture_ / (empty_ + ".txt"));
  WriteText(capture_ / "more/day1/wave_p09_r01.txt", "");
  WriteText(capture_ / "more/wave_p09_r02.txt", "");
  fs::create_directory(capture_ / "empty");
  const Result result = Run({});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json line = LogOf("more");
  EXPECT_EQ(line["decision"], "excluded");
  EXPECT_EQ(line["rule"], "folder_not_read");
  EXPECT_EQ(line["findings"][0]["value"], 2.0);
  EXPECT_THAT(line["reason"].get<std::string>(), HasSubstr("not looked at: 2 files"));
  EXPECT_THAT(result.out, HasSubstr("excluded by rule: 2,")) << "the brief clip and notes.doc; a folder is no clip";
  EXPECT_THAT(ReadText(folder_ / "r/curation_log.jsonl"), ::testing::Not(HasSubstr("\"empty\"")));
  const std::string counts = std::to_string(count_) + " clips, " + std::to_string(count_ - 2) +
                             " kept, excluded by rule: 2, 0 failed; 1 folder skipped";
  EXPECT_THAT(result.out, HasSubstr(counts));
  EXPECT_THAT(RunProgram(folder_, {"inspect", (folder_ / "r").string()}).out, HasSubstr(counts)) << "the same counts";
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("folder_not_read"))) << "no finding about a clip";
  EXPECT_THAT(result.err, HasSubstr("info: more: not looked at: 2 files")) << "no alarm";
  EXPECT_THAT(result.err, HasSubstr("warning: notes.doc: "));
  for (const char* doubled : {"more: more:", "notes.doc: notes.doc:"}) {
    EXPECT_THAT(result.err, ::testing::Not(HasSubstr(doubled)));
  }
  EXPECT_EQ(Run({"ingest.source.other_files=ignore"}, {"--json"}).Json()["excluded"], 1) << "the brief clip";
}

TEST(Capture, WithoutNoiseEveryFitConverges) {
  const ScratchFolder folder;
  std::vector<std::string> arguments = SmallJob(folder, "r");
  arguments.insert(arguments.end(), {"--json", "--set", "ingest.synthetic.noise=0", "--set",
                                     "ingest.synthetic.dropout=0", "--set", "ingest.synthetic.outlier=0"});
  const Result result = RunProgram(folder, arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(result.Json()["findings"].contains("fit_not_converged")) << result.Json()["findings"];
  EXPECT_LT(result.Json()["fit_error"]["joint_mm"], 0.2);
}

TEST(Capture, FilesOfOthersInTheFolderOfARunStayAndAreNotRead) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "calm"), SharedCache()).exit_code, 0);
  WriteText(folder / "r/capture/wave_p01_r9.txt", "mine");
  const Result result = RunProgram(folder, SmallJob(folder, "r"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(ReadText(folder / "r/capture/wave_p01_r9.txt"), "mine");
  EXPECT_EQ(ReadText(folder / "r/dataset.h5"), ReadText(folder / "calm/dataset.h5"));
}

TEST(Limits, AreOptionsOfTheConfig) {
  const ScratchFolder folder;
  const Result shown = RunProgram(
      folder, {"config", "show", "--set", "pipeline.item_timeout=2 min", "--set", "pipeline.item_memory=3 GiB"});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("item_timeout: 120"));
  std::vector<std::string> arguments = SmallJob(folder, "r");
  arguments.insert(arguments.end(), {"--set", "pipeline.item_memory=1 B"});
  const Result tight = RunProgram(folder, arguments);
  EXPECT_EQ(tight.exit_code, 3) << tight.err;
  EXPECT_THAT(tight.err, HasSubstr("ran past the memory limit of 1 bytes (pipeline.item_memory sets it)"));
  EXPECT_EQ(RunProgram(folder, {"run", "--set", "pipeline.item_memory=3 min"}).exit_code, 2);
}

/// Two people in a T-pose, and one whose arm hangs in the rest pose of their file.
std::string SmallBvh(const std::string& arm) {
  std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
      "JOINT Spine\n{\nOFFSET 0 50 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
      "JOINT Arm\n{\nOFFSET " +
      arm +
      "\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 25 0 0\n}\n}\n}\n}\n"
      "MOTION\nFrames: 30\nFrame Time: 0.033333\n";
  for (int f = 0; f < 30; ++f) text += std::to_string(f) + " 100 0 0 0 0 0 0 0 " + std::to_string(f) + " 0 0\n";
  return text;
}

TEST(CurationOfSets, AClipOfAnotherRestPoseIsExcludedByARuleAndNotKept) {
  const ScratchFolder folder;
  WriteText(folder / "c/p1_a.bvh", SmallBvh("40 0 0"));
  WriteText(folder / "c/p2_b.bvh", SmallBvh("41 0 0"));
  WriteText(folder / "c/p3_c.bvh", SmallBvh("0 -40 0"));
  WriteText(folder / "job.yaml",
            "ingest:\n  path: c\n  source:\n    name: arms\n    format: bvh\n    files: '{person}_{recording}.bvh'\n"
            "    person: '{person}'\n    recording: '{recording}'\n    units: cm\n    axes: '+x +y +z'\n"
            "fitting:\n  method: none\ncanon:\n  facing:\n    rule: none\nassemble:\n  splits: []\n");
  const Result result = RunProgram(
      folder, {"run", (folder / "job.yaml").string(), "-o", (folder / "r").string(), "-j", "1", "--to", "assemble"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 clips, 2 kept, excluded by rule: 1, 0 failed"));
  EXPECT_THAT(result.out, HasSubstr("other_skeleton"));
  EXPECT_THAT(result.err, HasSubstr("arms/p3/c"));
  int excluded = 0;
  const std::string log = ReadText(folder / "r/curation_log.jsonl");
  for (const std::string_view text : SplitText(log, '\n')) {
    if (text.empty()) continue;
    const nlohmann::json line = nlohmann::json::parse(text);
    if (line["decision"] != "excluded") continue;
    ++excluded;
    EXPECT_THAT(line["clip"].get<std::string>(), HasSubstr("p3"));
    EXPECT_EQ(line["stage"], "assemble");
    EXPECT_EQ(line["rule"], "other_skeleton");
    EXPECT_THAT(line["reason"].get<std::string>(), HasSubstr("joint_tracks"));
    EXPECT_NEAR(line["value"].get<double>(), 1.5708, 1e-3);
    EXPECT_GT(line["threshold"].get<double>(), 0.0);
  }
  EXPECT_EQ(excluded, 1);
  const Result seen = RunProgram(folder, {"inspect", (folder / "r").string()});
  EXPECT_THAT(seen.out, HasSubstr("2 kept"));
  EXPECT_THAT(seen.out, HasSubstr("in 2 clips"));
}

}  // namespace
}  // namespace mocurate
