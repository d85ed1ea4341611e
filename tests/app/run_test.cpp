// Whole runs: the same bytes whatever happens, a bad clip does not affect others, no work is repeated.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <regex>
#include <set>
#include <thread>

#include "core/base/random.h"
#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::FromCache;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::Started;
using program::WriteText;
using ::testing::HasSubstr;

int Items(const nlohmann::json& document) {
  int count = 0;
  for (const auto& stage : document["stages"]) count += stage["items"].get<int>();
  return count;
}

TEST(Run, GivesTheSameBytesWithOneAndTwoJobsAndServesTheSecondRunFromTheCache) {
  const ScratchFolder folder;
  std::vector<std::string> one = SmallJob(folder, "one", "1"), two = SmallJob(folder, "two", "2");
  for (std::vector<std::string>* job : {&one, &two}) job->insert(job->end(), {"--set", "fitting.solver=ceres"});
  one.emplace_back("--json");
  const Result first = RunProgram(folder, one, "cache1");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_GT(first.Json()["kept"], 10);
  ASSERT_EQ(RunProgram(folder, two, "cache2").exit_code, 0);
  EXPECT_EQ(ReadText(folder / "one/dataset.h5"), ReadText(folder / "two/dataset.h5"));
  EXPECT_EQ(ReadText(folder / "one/curation_log.jsonl"), ReadText(folder / "two/curation_log.jsonl"));
  const Result again = RunProgram(folder, one, "cache1");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(FromCache(again.Json()), Items(again.Json()));
}

TEST(Run, AnOptionOfCanonRepeatsNoEarlierStage) {
  const ScratchFolder folder;
  std::vector<std::string> arguments = SmallJob(folder, "r");
  arguments.emplace_back("--json");
  ASSERT_EQ(RunProgram(folder, arguments).exit_code, 0);
  arguments.insert(arguments.end(), {"--set", "canon.facing.anchor=last"});
  const Result changed = RunProgram(folder, arguments);
  ASSERT_EQ(changed.exit_code, 0) << changed.err;
  for (const auto& stage : changed.Json()["stages"]) {
    const bool before = stage["stage"] == "ingest" || stage["stage"] == "fitting" || stage["stage"] == "proportions";
    if (before) {
      EXPECT_EQ(stage["from_cache"], stage["items"]) << stage["stage"];
    } else if (stage["stage"] == "canon") {
      EXPECT_EQ(stage["from_cache"], 0);
    }
  }
}

TEST(Run, ABadClipDoesNotAffectOthersAndToleranceDecidesTheExitCode) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "r")).exit_code, 0);
  // The capture is a folder like any other: take it as a source, with one file emptied and one cut off.
  const fs::path capture = folder / "capture";
  fs::copy(folder / "r/capture", capture);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(capture)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_GT(files.size(), 5u);
  WriteText(files[1], "");
  const std::string text = ReadText(files[3]);
  WriteText(files[3], text.substr(0, text.size() / 2 + 7));
  WriteText(capture / "notes.doc", "not a capture");

  const auto job = [&](const std::string& tolerated) {
    std::vector<std::string> arguments = SmallJob(folder, "bad");
    arguments.insert(arguments.end(),
                     {"--set", "ingest.synthetic.enabled=false", "--set", "ingest.path=" + capture.string(), "--set",
                      "tolerated_failures=" + tolerated, "--json"});
    return RunProgram(folder, arguments);
  };
  const Result strict = job("0");
  EXPECT_EQ(strict.exit_code, 1) << strict.err;
  const Result tolerant = job("0.5");
  EXPECT_EQ(tolerant.exit_code, 0) << tolerant.err;
  EXPECT_EQ(tolerant.Json()["kept"], static_cast<int>(files.size()) - 1) << "whole rows of the cut file stay";
  EXPECT_EQ(tolerant.Json()["failed"], 1);
  EXPECT_EQ(tolerant.Json()["suspect"], 1);
  const std::string log = ReadText(folder / "bad/curation_log.jsonl");
  EXPECT_THAT(log, HasSubstr("\"decision\":\"dropped\""));
  EXPECT_THAT(log, HasSubstr("cut_off"));
}

/// Four clips with their page; nothing is trained.
std::vector<std::string> PagedJob(const ScratchFolder& folder, const std::string& output) {
  std::vector<std::string> arguments = SmallJob(folder, output);
  std::replace(arguments.begin(), arguments.end(), std::string("assemble"), std::string("report"));
  for (const char* assignment : {"ingest.synthetic.actions=[walk, wave]", "ingest.synthetic.subjects=2",
                                 "train.networks=[]", "report.videos=false", "tolerated_suspect=1"}) {
    arguments.insert(arguments.end(), {"--set", assignment});
  }
  return arguments;
}

/// The number of an attribute of the page's headline; 0 where it has none.
double OfHeadline(const fs::path& run, const std::string& attribute) {
  std::smatch found;
  const std::string page = ReadText(run / "report/index.html");
  const std::regex headline("<p class=\"verdict\"[^>]* data-" + attribute + "=\"([0-9.]+)\"");
  return std::regex_search(page, found, headline) ? std::stod(found[1]) : 0.0;
}

TEST(Run, ThePageMarksFitsFarFromTheTruthAsSuspect) {
  const ScratchFolder folder;
  std::vector<std::string> job = PagedJob(folder, "r");
  job.emplace_back("--json");
  const Result sound = RunProgram(folder, job);
  ASSERT_EQ(sound.exit_code, 0) << sound.err;
  EXPECT_LT(sound.Json()["fit_error"]["joint_mm"], 150.0);
  EXPECT_EQ(OfHeadline(folder / "r", "joint-error-mm"), 0.0);
  job.insert(job.end(), {"--set", "ingest.source.axes=+x -y +z"});  // upside down
  const Result turned = RunProgram(folder, job);
  ASSERT_EQ(turned.exit_code, 0) << turned.err;
  const double mean_mm = turned.Json()["fit_error"]["joint_mm"];
  EXPECT_GT(mean_mm, 150.0);
  EXPECT_GE(OfHeadline(folder / "r", "joint-error-mm"), std::floor(mean_mm)) << "of the worst clip";
  EXPECT_GE(OfHeadline(folder / "r", "suspect-clips"), turned.Json()["suspect"].get<double>());
}

/// Six clips: long enough to be killed in every stage, short enough to be killed ten times.
std::vector<std::string> SixClips(const ScratchFolder& folder, const std::string& output) {
  std::vector<std::string> arguments = SmallJob(folder, output);
  arguments.insert(arguments.end(),
                   {"--set", "ingest.synthetic.actions=[kick, squat, wave]", "--set", "ingest.synthetic.subjects=2"});
  return arguments;
}

/// Starts the job until it ends, killing it at times distributed over the length of an undisturbed run. Counts the
/// kills; returns their stages.
std::set<std::string> RunUnderKills(const ScratchFolder& folder, const std::string& output,
                                    std::chrono::microseconds& length, Random& random, int& kills_left) {
  std::set<std::string> stages;
  bool first = true;
  for (;;) {
    Started run(folder, SixClips(folder, output), output + "_cache");
    const auto start = std::chrono::steady_clock::now();
    const std::chrono::microseconds kill_after(random.Below(static_cast<std::uint64_t>(length.count())));
    while (run.Running() && (kills_left == 0 || std::chrono::steady_clock::now() < start + kill_after))
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const bool kill = run.Running();
    if (kill) run.Signal(SIGKILL);
    // The machine may have been busy while the length was measured: kills must hit the runs.
    const auto lasted = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
    if (first && !kill) length = std::min(length, lasted);
    first = false;
    const Result result = run.Wait();
    if (result.exit_code != 128 + SIGKILL) {
      EXPECT_EQ(result.exit_code, 0) << result.err;
      return stages;
    }
    --kills_left;
    const std::string journal = ReadText(folder / (output + "/journal.jsonl"));
    const std::size_t last = journal.rfind("\"stage\":\"");
    stages.insert(last == std::string::npos ? "start"
                                            : journal.substr(last + 9, journal.find('"', last + 9) - last - 9));
  }
}

TEST(Run, SurvivesRandomKillsSpreadOverItAndEndsWithTheSameBytes) {
  const ScratchFolder folder;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(RunProgram(folder, SixClips(folder, "calm"), "calm_cache").exit_code, 0);
  auto length = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
  const std::string calm = ReadText(folder / "calm/dataset.h5");
  Random random(7, "kills");
  std::set<std::string> stages;
  int kills_left = 10;
  for (int run = 0; kills_left > 0; ++run) {
    ASSERT_LT(run, 100) << "hardly any kill meets a run";
    const std::string name = "stormy" + std::to_string(run);
    stages.merge(RunUnderKills(folder, name, length, random, kills_left));
    EXPECT_TRUE(calm == ReadText(folder / (name + "/dataset.h5"))) << name;
    EXPECT_EQ(RunProgram(folder, {"cache", "verify"}, name + "_cache").exit_code, 0) << "what is visible is whole";
  }
  std::string met;
  for (const std::string& stage : stages) met += stage + " ";
  RecordProperty("last_stage_in_the_journal_at_the_kills", met);
}

TEST(Run, StopsOnRequestWith75AndContinues) {
  const ScratchFolder folder;
  Started run(folder, SmallJob(folder, "r", "1"));
  while (run.Running() && !fs::exists(folder / "r/journal.jsonl"))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  run.Signal(SIGTERM);
  const Result stopped = run.Wait();
  EXPECT_EQ(stopped.exit_code, 75) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("again to "));
  EXPECT_EQ(RunProgram(folder, SmallJob(folder, "r", "1")).exit_code, 0);
}

TEST(Run, FolderNamesMayHoldBlanksAndBytesThatAreNotUtf8) {
  const ScratchFolder folder;
  const std::string odd = "my r\xfcn";
  const Result result = RunProgram(folder, SmallJob(folder, odd));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(folder.path() / odd / "dataset.h5"));
}

TEST(Run, TwoRunsOfOneFolderAreRefused) {
  const ScratchFolder folder;
  Started first(folder, SmallJob(folder, "r", "1"));
  while (first.Running() && !fs::exists(folder / "r/journal.jsonl"))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const ScratchFolder other;
  std::vector<std::string> arguments = SmallJob(folder, "r", "1");
  const Result second = RunProgram(other, arguments);
  EXPECT_NE(second.exit_code, 0);
  EXPECT_THAT(second.err, HasSubstr("another run is at work"));
  first.Wait();
}

}  // namespace
}  // namespace mocurate
