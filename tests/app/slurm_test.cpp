// A run as arrays of Slurm. tests/app/slurm_shim stands for Slurm's programs, with its recorded texts;
// scripts/test_slurm.sh does the same with real daemons.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "job/slurm.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::Surroundings;
using program::WriteText;

const fs::path kRecorded = std::string(kSourceFolder) + "/tests/data/slurm";

std::string Recorded(const std::string& name) { return ReadText(kRecorded / (name + ".txt")); }

TEST(SlurmTexts, LimitsOfTheCluster) {
  const SlurmLimits limits = ParseSlurmLimits(Recorded("config"));
  EXPECT_EQ(limits.array_size, 1001u);
  EXPECT_EQ(limits.jobs, 10000u);
  EXPECT_EQ(ParseSlurmLimits("MaxArraySize = 40001\n").array_size, 40001u);
  EXPECT_EQ(ParseSlurmLimits("MaxArraySize = 0\nnothing").array_size, 1001u);
}

TEST(SlurmTexts, NumbersOfJobs) {
  for (const char* name : {"sbatch_parsable", "sbatch_array_parsable"}) {
    const auto id = ParseSubmission(0, Recorded(name));
    ASSERT_TRUE(id) << id.error().Message();
    EXPECT_EQ(*id, std::string(Recorded(name), 0, Recorded(name).find('\n')));
  }
  EXPECT_EQ(ParseSubmission(0, "sbatch: Job runs on all nodes\n12;cluster\n").value_or(""), "12");
  EXPECT_FALSE(ParseSubmission(0, ""));
}

TEST(SlurmTexts, RefusalsNameTheOption) {
  const std::pair<const char*, const char*> options[] = {
      {"sbatch_no_partition", "slurm.partition"},       {"sbatch_enforced_account", "slurm.account"},
      {"sbatch_too_much_memory", "slurm.memory"},       {"sbatch_bad_time", "slurm.time"},
      {"sbatch_enforced_too_many_cpus", "slurm.cores"}, {"sbatch_array_too_large", "slurm.most_tasks"},
      {"sbatch_unknown_option", "slurm.sbatch"}};
  for (const auto& [name, option] : options) {
    const auto id = ParseSubmission(1, Recorded(name));
    ASSERT_FALSE(id) << name;
    EXPECT_EQ(id.error().code, ErrorCode::kConfig) << name;
    EXPECT_EQ(id.error().where, option) << name;
  }
  EXPECT_EQ(ParseSubmission(1, Recorded("sbatch_no_controller")).error().code, ErrorCode::kMissingOnHost);
  EXPECT_EQ(ParseSubmission(1, "").error().code, ErrorCode::kMissingOnHost);
}

TEST(SlurmTexts, TheQueue) {
  const std::vector<QueuedJob> running = ParseQueue(Recorded("squeue_array_running_expanded"));
  ASSERT_EQ(running.size(), 10u);
  EXPECT_EQ(running[0].id, "11");
  EXPECT_EQ(running[0].state, "PENDING");
  EXPECT_EQ(running[0].reason, "Resources");
  EXPECT_EQ(running[9].id, "11");
  EXPECT_TRUE(ParseQueue(Recorded("squeue_unknown_job")).empty());
  EXPECT_TRUE(ParseQueue("").empty());
  for (const auto& file : fs::directory_iterator(kRecorded)) ParseQueue(ReadText(file.path()));
}

TEST(SlurmTexts, Times) {
  EXPECT_EQ(SlurmTime(61.0), "0-00:01:01");
  EXPECT_EQ(SlurmTime(2.0 * 86400.0 + 3.0 * 3600.0 + 0.5), "2-03:00:01");
}

/// A capture, the arguments of a run over it, and programs that stand for Slurm's.
class SlurmRuns : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    ASSERT_EQ(RunProgram(*folder_, SmallJob(*folder_, "made"), program::SharedCache()).exit_code, 0);
    fs::copy(*folder_ / "made/capture", *folder_ / "capture");
    plain_ = RunProgram(*folder_, Arguments("plain"), program::SharedCache());
    ASSERT_EQ(plain_.exit_code, 0) << plain_.err;
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::vector<std::string> Arguments(const std::string& run, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = SmallJob(*folder_, run);
    arguments.insert(arguments.end(), {"--set", "ingest.path=" + (*folder_ / "capture").native()});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  static std::vector<std::string> OnSlurm(const std::string& run, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments =
        Arguments(run, {"--executor", "slurm", "--set", "slurm.task_time=0.1 s", "--set", "slurm.pilot=2"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// Runs with the programs that stand for Slurm's in PATH. `run`: whose cache and queue; "plain" has the shared cache,
  /// with all that a plain run makes. `refusal`: name of a recorded text that sbatch answers with.
  static Result Run(const std::vector<std::string>& arguments, const std::string& run,
                    const std::string& refusal = {}) {
    Surroundings surroundings;
    surroundings.cache = run == "plain" ? program::SharedCache() : run + "_cache";
    surroundings.before_start = [run, refusal] {
      const fs::path state = *folder_ / (run + "_shim");
      fs::create_directories(state);
      setenv("SHIM", state.c_str(), 1);
      if (chdir(folder_->path().c_str()) != 0) _exit(127);
      setenv("SHIM_RECORDED", kRecorded.c_str(), 1);
      setenv("SHIM_REFUSE", refusal.c_str(), 1);
      setenv("PATH", (std::string(kSourceFolder) + "/tests/app/slurm_shim:" + std::string(getenv("PATH"))).c_str(), 1);
    };
    return RunProgram(*folder_, arguments, surroundings);
  }

  static std::string Logs(const std::string& run) {
    std::ostringstream text;
    std::error_code none;
    for (fs::directory_iterator it(*folder_ / run / "slurm/logs", none), end; !none && it != end; it.increment(none))
      text << it->path().filename().native() << ": " << ReadText(it->path()) << "\n";
    return text.str();
  }

  static void ExpectPlainBytes(const std::string& run) {
    EXPECT_EQ(ReadText(*folder_ / run / "dataset.h5"), ReadText(*folder_ / "plain/dataset.h5")) << Logs(run);
    EXPECT_EQ(ReadText(*folder_ / run / "curation_log.jsonl"), ReadText(*folder_ / "plain/curation_log.jsonl"));
  }

  static ScratchFolder* folder_;
  static Result plain_;
};

ScratchFolder* SlurmRuns::folder_ = nullptr;
Result SlurmRuns::plain_;

/// Everything is in the cache, so that only the last job runs.
TEST_F(SlurmRuns, AFolderOfAnotherJobIsReplacedByTheLastJobToo) {
  ASSERT_EQ(RunProgram(*folder_, Arguments("replaced", {"--set", "name=before"}), program::SharedCache()).exit_code, 0);
  EXPECT_EQ(Run(OnSlurm("replaced"), "plain").exit_code, 2);
  const Result replaced = Run(OnSlurm("replaced", {"--replace"}), "plain");
  EXPECT_EQ(replaced.exit_code, 0) << replaced.err << Logs("replaced");
}

/// Slow: some twenty programs.
TEST_F(SlurmRuns, ArraysGiveTheBytesOfAPlainRun) {
  const std::vector<std::string> scratch = {"--set", "slurm.scratch=$SHIM/scratch", "--set",
                                            "slurm.prologue=[\"mkdir -p $SHIM/scratch\"]"};
  std::vector<std::string> left = OnSlurm("arrays", scratch);
  left.push_back("--no-wait");
  const Result submitted = Run(left, "arrays");
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  const std::vector<std::string> ask = {"jobs", (*folder_ / "arrays").native(), "--json"};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Run(ask, "arrays").exit_code, 0);
  const std::string asked = ReadText(*folder_ / "arrays_shim/squeue_calls");
  EXPECT_LE(std::count(asked.begin(), asked.end(), '\n'), 1) << "once a minute";
  const Result joined = Run(OnSlurm("arrays", scratch), "arrays");
  ASSERT_EQ(joined.exit_code, 0) << joined.err << Logs("arrays");
  ExpectPlainBytes("arrays");
  const nlohmann::json shown = Run(ask, "arrays").Json();
  EXPECT_EQ(shown["outcome"]["exit_code"], 0);
  std::size_t arrays = 0;
  for (const auto& job : shown["jobs"]) {
    if (!job.contains("tasks")) continue;
    ++arrays;
    EXPECT_EQ(job["done"], job["tasks"]) << job;
    EXPECT_GT(job["used_bytes"], 0.0);
  }
  EXPECT_GE(arrays, 3u) << shown;
  EXPECT_EQ(Run({"jobs", (*folder_ / "arrays").native()}, "arrays").exit_code, 0);

  const std::string ended = ReadText(*folder_ / "arrays/slurm/outcome.json");
  EXPECT_EQ(Run({"jobs", (*folder_ / "arrays").native(), "--next"}, "arrays").exit_code, 2) << "the run has ended";
  EXPECT_EQ(ReadText(*folder_ / "arrays/slurm/outcome.json"), ended);

  fs::remove(*folder_ / "arrays/slurm/queue.txt");
  WriteText(*folder_ / "arrays_shim/down", "");
  for (int i = 0; i < 2; ++i) {
    const Result down = Run(ask, "arrays");
    EXPECT_EQ(down.exit_code, 0);
    EXPECT_EQ(down.Json()["queued"], nullptr) << "no answer is not an empty queue";
  }
  fs::remove(*folder_ / "arrays_shim/down");

  const Result again = Run(OnSlurm("arrays", scratch), "arrays");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const nlohmann::json in_the_end = Run(ask, "arrays").Json();
  EXPECT_GT(in_the_end["jobs"].size(), 0u);
  for (const auto& job : in_the_end["jobs"]) EXPECT_FALSE(job.contains("tasks")) << "nothing was missing: " << job;
}

/// Slow: likewise.
TEST_F(SlurmRuns, ATaskThatCannotWorkIsTriedThreeTimes) {
  const Result ran =
      Run(OnSlurm("broken", {"--set", "slurm.prologue=[\"[ -z \\\"$SLURM_ARRAY_TASK_ID\\\" ] || exit 9\"]"}), "broken");
  EXPECT_EQ(ran.exit_code, 1) << ran.err << Logs("broken");
  const Result jobs = Run({"jobs", (*folder_ / "broken").native(), "--json"}, "broken");
  const nlohmann::json shown = jobs.Json();
  std::size_t arrays = 0;
  for (const auto& job : shown["jobs"]) {
    if (!job.contains("tasks")) continue;
    ++arrays;
    EXPECT_EQ(job["lost"], job["tasks"]) << job;
  }
  EXPECT_EQ(arrays, 3u) << jobs.out;
  EXPECT_FALSE(fs::exists(*folder_ / "broken/dataset.h5"));
  // Corrected, it goes on with what is there; here the front end submits everything.
  const Result repaired = Run(OnSlurm("broken", {"--set", "slurm.submit_from=login"}), "broken");
  EXPECT_EQ(repaired.exit_code, 0) << repaired.err << Logs("broken");
  ExpectPlainBytes("broken");
}

/// Jobs load the configuration from elsewhere; everything but the dataset is in the cache.
TEST_F(SlurmRuns, PathsAreRelativeToTheConfiguration) {
  WriteText(*folder_ / "relative.yaml", "include: demo.yaml\ningest:\n  path: capture\n");
  std::vector<std::string> arguments = SmallJob(*folder_, "relative");
  arguments.insert(arguments.begin() + 1, "relative.yaml");
  arguments.insert(arguments.end(), {"--executor", "slurm"});
  const Result ran = Run(arguments, "plain");
  EXPECT_EQ(ran.exit_code, 0) << ran.err << Logs("relative");
  EXPECT_TRUE(fs::exists(*folder_ / "relative/dataset.h5"));
}

/// A run folder is handed on: nothing in it is a command.
TEST_F(SlurmRuns, AFolderOfAStrangerIsOnlyRead) {
  ASSERT_EQ(Run(OnSlurm("theirs", {"--no-wait"}), "theirs", "sbatch_no_controller").exit_code, 4);
  const fs::path own = *folder_ / "theirs/slurm";
  fs::remove(own / "outcome.json");
  nlohmann::json run = nlohmann::json::parse(ReadText(own / "run.json"));
  const std::string evil = "touch '" + (*folder_ / "PWN").native() + "'; false";
  run["program"] = run["prologue"] = evil;
  run["config"] = (*folder_ / "evil.yaml").native();
  run["assignments"] = {"slurm.program=" + evil};
  run["working_folder"] = folder_->path().native();
  WriteText(*folder_ / "evil.yaml", "slurm:\n  program: \"" + evil + "\"\n");
  WriteText(own / "run.json", run.dump());
  const std::string folder = (*folder_ / "theirs").native();
  EXPECT_EQ(Run({"jobs", folder}, "theirs").exit_code, 0);
  EXPECT_EQ(Run({"jobs", folder, "--next"}, "theirs").exit_code, 2) << "of which configuration?";
  std::vector<std::string> next = OnSlurm("theirs");
  next.erase(next.begin(), next.begin() + 7);  // run -o RUN --to assemble --jobs 2
  next.erase(std::find(next.begin(), next.end(), "--executor"), std::find(next.begin(), next.end(), "--executor") + 2);
  next.insert(next.begin(), {"jobs", folder, "--next", "--config", "demo"});
  const Result went_on = Run(next, "theirs", "sbatch_no_controller");
  EXPECT_EQ(went_on.exit_code, 4) << went_on.err;
  EXPECT_EQ(ReadText(own / "step.sh").find("PWN"), std::string::npos);
  EXPECT_FALSE(fs::exists(*folder_ / "PWN"));

  const std::string jobs = ReadText(own / "jobs.jsonl");
  for (const char* line :
       {"{\"kind\":\"array\",\"job\":\"7\",\"stage\":\"ingest\",\"tasks\":1000000000000,\"items\":1000000000000}",
        "{\"kind\":\"array\",\"job\":\"7\",\"stage\":\"ingest\",\"tasks\":-1,\"items\":5}",
        "{\"kind\":\"array\",\"job\":\"7\",\"stage\":\"../..\",\"tasks\":1,\"items\":5}",
        "{\"kind\":[],\"job\":{},\"stage\":7,\"tasks\":\"many\"}", "{\"job\":\"--help\",\"kind\":\"step\"}",
        "{\"kind\":\"step\",\"job\":\"7\",\"time_s\":\"long\"}"}) {
    WriteText(own / "jobs.jsonl", jobs + line + "\n");
    EXPECT_EQ(Run({"jobs", folder}, "theirs").exit_code, 3) << line;
  }
  WriteText(own / "jobs.jsonl",
            jobs + "{\"kind\":\"array\",\"job\":\"7\",\"stage\":\"ingest\",\"tasks\":2,\"items\":2}\n");
  WriteText(*folder_ / "theirs/plan/ingest/0.jsonl",
            "{\"task\":0,\"job\":7,\"event\":[]}\n{\"task\":0,\"job\":\"7\",\"event\":\"begun\",\"time\":9}\n"
            "{\"task\":0,\"job\":\"7\",\"event\":\"ended\",\"exit_code\":\"x\",\"workers\":{}}\n");
  EXPECT_EQ(Run({"jobs", folder}, "theirs").exit_code, 0);
  WriteText(own / "outcome.json", "{\"exit_code\":\"x\",\"message\":7}");
  EXPECT_EQ(Run({"jobs", folder}, "theirs").exit_code, 3);
}

/// Scripts have a line an option.
TEST_F(SlurmRuns, LineEndsDoNotReachAScript) {
  for (const char* option : {"partition", "account", "step.partition", "scratch"}) {
    const std::string assignment = "slurm." + std::string(option) + "=\"a\\ntouch PWN\"";
    EXPECT_EQ(Run(OnSlurm("lines", {"--set", assignment}), "lines").exit_code, 2) << option;
  }
  EXPECT_EQ(Run(OnSlurm("lines", {"--set", "slurm.sbatch=[\"--qos=a\\ntouch PWN\"]"}), "lines").exit_code, 2);
  EXPECT_EQ(Run(OnSlurm("lines\ntouch PWN"), "lines").exit_code, 2);
  EXPECT_EQ(Run(OnSlurm("lines\" --wrap=\"touch PWN"), "lines").exit_code, 2);
  EXPECT_FALSE(fs::exists(*folder_ / "lines_shim/next")) << "nothing was submitted";
}

TEST_F(SlurmRuns, RefusalsHaveTheirCodes) {
  EXPECT_EQ(Run(OnSlurm("refused"), "refused", "sbatch_no_partition").exit_code, 2);
  const Result own =
      Run(OnSlurm("refused", {"--json", "--set", "slurm.step.memory=9 TB"}), "refused", "sbatch_too_much_memory");
  EXPECT_EQ(own.exit_code, 2);
  EXPECT_EQ(own.Json()["error"]["where"], "slurm.step.memory") << own.out;
  EXPECT_EQ(Run(OnSlurm("refused"), "refused", "sbatch_no_controller").exit_code, 4);
  Surroundings without;
  without.before_start = [] { setenv("PATH", "/nowhere", 1); };
  EXPECT_EQ(RunProgram(*folder_, OnSlurm("refused"), without).exit_code, 4) << "no Slurm on this machine";
  EXPECT_EQ(Run({"jobs", (*folder_ / "plain").native()}, "refused").exit_code, 3) << "no run on Slurm";
  EXPECT_EQ(Run(OnSlurm("refused", {"--set", "slurm.time=1 s"}), "refused").exit_code, 2) << "too short for USR1@90";
}

}  // namespace
}  // namespace mocurate
