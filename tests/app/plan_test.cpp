// Stages cut into tasks: the same bytes as a plain run, nothing done twice, and clear refusals.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>

#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::FromCache;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::WriteText;

/// A folder with a capture, and the arguments of a run over it.
class Plans : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    const std::vector<std::string> made = SmallJob(*folder_, "made");
    ASSERT_EQ(RunProgram(*folder_, made, program::SharedCache()).exit_code, 0);
    fs::copy(*folder_ / "made/capture", *folder_ / "capture");
    plain_ = RunProgram(*folder_, Run("plain"), program::SharedCache());
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::vector<std::string> Arguments(const std::string& verb, const std::string& run) {
    std::vector<std::string> arguments = SmallJob(*folder_, run);
    arguments.front() = verb;
    if (verb == "plan") arguments.erase(arguments.begin() + 3, arguments.begin() + 5);  // --to
    arguments.insert(arguments.end(), {"--set", "ingest.path=" + (*folder_ / "capture").native(), "--json"});
    return arguments;
  }
  static std::vector<std::string> Run(const std::string& run) { return Arguments("run", run); }
  static std::vector<std::string> PlanOf(const std::string& run, const std::string& stage, const std::string& tasks) {
    std::vector<std::string> arguments = Arguments("plan", run);
    arguments.insert(arguments.end(), {"--stage", stage, "--tasks", tasks});
    return arguments;
  }
  static std::vector<std::string> Task(const std::string& run, const std::string& stage, std::size_t task) {
    return {"run",   "--plan", (*folder_ / run / "plan" / (stage + ".json")).native(), "--task", std::to_string(task),
            "--json"};
  }

  static ScratchFolder* folder_;
  static Result plain_;
};

ScratchFolder* Plans::folder_ = nullptr;
Result Plans::plain_;

/// Slow: each task is a program that starts its workers.
TEST_F(Plans, AnyNumberOfTasksGivesTheBytesOfAPlainRun) {
  ASSERT_EQ(plain_.exit_code, 0) << plain_.err;
  for (const char* tasks : {"1", "4"}) {
    const std::string run = std::string("of") + tasks, cache = run + "_cache";
    const bool all = run == "of4";  // else the few items of other stages are left to the plan of the next
    for (const char* stage : {"ingest", "proportions", "fitting", "canon"}) {
      if (!all && stage != std::string("ingest") && stage != std::string("fitting")) continue;
      const Result plan = RunProgram(*folder_, PlanOf(run, stage, tasks), cache);
      ASSERT_EQ(plan.exit_code, 0) << stage << ": " << plan.err;
      const auto count = plan.Json()["tasks"].get<std::size_t>();
      EXPECT_LE(count, std::stoul(tasks));
      for (std::size_t k = 0; k < count; ++k) {
        std::vector<std::string> task = Task(run, stage, k);
        task.insert(task.end(), {"--scratch", (*folder_ / "scratch").native()});
        const Result done = RunProgram(*folder_, task, cache);
        ASSERT_EQ(done.exit_code, 0) << done.err;
        EXPECT_EQ(done.Json()["from_cache"], 0);
      }
      if (!all) continue;
      const Result again = RunProgram(*folder_, PlanOf(run, stage, tasks), cache);
      ASSERT_EQ(again.exit_code, 0) << again.err;
      EXPECT_EQ(again.Json()["tasks"], 0);
    }
    const Result whole = RunProgram(*folder_, Run(run), cache);
    ASSERT_EQ(whole.exit_code, 0) << whole.err;
    for (const auto& stage : whole.Json()["stages"]) {
      const std::string name = stage["stage"];
      if (name == "ingest" || name == "proportions" || name == "fitting" || (all && name == "canon")) {
        EXPECT_EQ(stage["from_cache"], stage["items"]) << name;
      }
    }
    EXPECT_EQ(ReadText(*folder_ / run / "dataset.h5"), ReadText(*folder_ / "plain/dataset.h5")) << tasks;
    EXPECT_EQ(ReadText(*folder_ / run / "curation_log.jsonl"), ReadText(*folder_ / "plain/curation_log.jsonl"));
  }
}

TEST_F(Plans, RefusalsHaveTheirCodes) {
  std::vector<std::string> too_early = PlanOf("r", "fitting", "2");
  too_early.insert(too_early.end(), {"--leftovers", "1"});
  EXPECT_EQ(RunProgram(*folder_, too_early, "r_cache").exit_code, 3) << "ingest is not done";
  EXPECT_EQ(RunProgram(*folder_, PlanOf("r", "report", "2"), "r_cache").exit_code, 2) << "no item per clip";
  ASSERT_EQ(RunProgram(*folder_, PlanOf("r", "ingest", "2"), "r_cache").exit_code, 0);
  const fs::path plan = *folder_ / "r/plan/ingest.json";
  EXPECT_EQ(RunProgram(*folder_, Task("r", "ingest", 2), "r_cache").exit_code, 2) << "beyond the last task";
  EXPECT_EQ(RunProgram(*folder_, {"run", "--plan", plan.native()}, "r_cache").exit_code, 2) << "which task?";
  EXPECT_EQ(RunProgram(*folder_, {"run", "--plan", (*folder_ / "none").native(), "--task", "0"}).exit_code, 3);
  const std::string text = ReadText(plan);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    WriteText(plan, other);
    return RunProgram(*folder_, Task("r", "ingest", 0), "r_cache").exit_code;
  };
  EXPECT_EQ(with("\"stage_version\":", "\"stage_version\":9"), 3) << "another version of the stage";
  EXPECT_EQ(with("\"config_sha256\":\"", "\"config_sha256\":\"0"), 3) << "another configuration";
  EXPECT_EQ(with("\"instructions\":\"", "\"instructions\":\"future_"), 4) << "a better CPU";
  WriteText(plan, text);
  WriteText(*folder_ / "r/plan/ingest/0.claim", "another_host 1\n");
  EXPECT_EQ(RunProgram(*folder_, Task("r", "ingest", 0), "r_cache").exit_code, 2) << "at work elsewhere";
  fs::last_write_time(*folder_ / "r/plan/ingest/0.claim", fs::file_time_type::clock::now() - std::chrono::minutes(5));
  EXPECT_EQ(RunProgram(*folder_, Task("r", "ingest", 0), "r_cache").exit_code, 0) << "its host has died";
  EXPECT_FALSE(fs::exists(*folder_ / "r/plan/ingest/0.claim"));
}

/// Plans are handed on: what they say is compared with the configuration, the program and the data.
TEST_F(Plans, APlanOfAStrangerDoesNothingOfItsOwn) {
  ASSERT_EQ(RunProgram(*folder_, PlanOf("s", "ingest", "1"), "s_cache").exit_code, 0);
  const auto change = [](const std::string& stage, const std::function<void(std::string&)>& edit) {
    const fs::path plan = *folder_ / "s/plan" / (stage + ".json");
    const std::string text = ReadText(plan);
    std::string other = text;
    edit(other);
    EXPECT_NE(other, text);
    WriteText(plan, other);
    const Result task = RunProgram(*folder_, Task("s", stage, 0), "s_cache");
    WriteText(plan, text);
    return task;
  };
  const auto replaced = [](const std::string& from, const std::string& to) {
    return [from, to](std::string& text) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    };
  };
  // Items are run by the program that this one belongs to.
  const fs::path program = *folder_ / "worker";
  WriteText(program, "#!/bin/sh\ntouch '" + (*folder_ / "PWN").native() + "'\n");
  fs::permissions(program, fs::perms::owner_all);
  const auto with_worker = [&](std::string& text) {
    text.insert(text.find("\"stage\":\"ingest\""),
                "\"worker\":\"" + program.native() + "\",\"limits\":{\"time_s\":60.0},");
  };
  const Result worked = change("ingest", with_worker);
  EXPECT_EQ(worked.exit_code, 0) << worked.err;
  EXPECT_EQ(worked.Json()["from_cache"], 0) << "by mocurate's own worker";
  EXPECT_EQ(change("ingest", replaced("\"stage\":\"ingest\"", "\"stage\":\"canon\" ")).exit_code, 3);
  EXPECT_EQ(change("ingest", replaced("\"stage\":\"ingest\"", "\"stage\":\"../../x\"")).exit_code, 3);
  EXPECT_FALSE(fs::exists(*folder_ / "PWN"));
  // Options are those of the configuration.
  EXPECT_EQ(change("ingest", replaced("\"first_frame\":{}", "\"first_fram\":{} ")).exit_code, 3);
  ASSERT_EQ(RunProgram(*folder_, PlanOf("s", "fitting", "1"), "s_cache").exit_code, 0);
  EXPECT_EQ(change("fitting", replaced("\"method\":\"", "\"meth\":\"od")).exit_code, 3);
  // A file under the hash of another is refused: nothing of it is served afterwards.
  const auto swapped = [](std::string& text) {
    const std::string a = "kick", b = "walk";
    const std::size_t at = text.find(a, text.find("\"inputs\""));
    ASSERT_NE(at, std::string::npos);
    const std::size_t path = text.find(a, text.find("/capture/", at));
    text.replace(path, a.size(), b);
  };
  fs::remove_all(*folder_ / "s_cache/objects");
  fs::create_directory(*folder_ / "s_cache/objects");
  const Result task = change("ingest", swapped);
  EXPECT_EQ(task.exit_code, 1) << task.err;
  EXPECT_EQ(task.Json()["refused"], 1);
  EXPECT_EQ(RunProgram(*folder_, Run("s"), "s_cache").exit_code, 0);
  EXPECT_EQ(ReadText(*folder_ / "s/dataset.h5"), ReadText(*folder_ / "plain/dataset.h5"));
}

/// Its tree is that of its file: no skeleton is named, and an input has no path.
TEST_F(Plans, OfMotionsWithTheirOwnTree) {
  WriteText(
      *folder_ / "own/a_walk.bvh",
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
      "Zrotation Xrotation Yrotation\nJOINT Spine\n{\nOFFSET 0 10 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd "
      "Site\n{\nOFFSET 0 10 0\n}\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.033333\n0 90 0 0 0 0 0 0 0\n0 90 1 0 0 0 "
      "0 5 0\n0 90 2 0 0 0 0 9 0\n");
  WriteText(*folder_ / "own.yaml",
            "ingest:\n  path: own\n  source: {name: own, format: bvh, files: '{person}_{recording}.bvh', "
            "label: '{recording}', units: cm, axes: '+x +y +z', skeleton: ''}\nfitting: {method: none}\n");
  std::vector<std::string> plan = {"plan", (*folder_ / "own.yaml").native(), "--stage", "ingest", "--tasks", "1",
                                   "-o",   (*folder_ / "own_run").native(),  "--json"};
  const Result made = RunProgram(*folder_, plan, "own_cache");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.Json()["items"], 1);
  const Result task = RunProgram(*folder_, Task("own_run", "ingest", 0), "own_cache");
  EXPECT_EQ(task.exit_code, 0) << task.err << task.out;
}

TEST_F(Plans, ATaskWritesNothingThroughLinks) {
  ASSERT_EQ(RunProgram(*folder_, PlanOf("links", "ingest", "2"), "links_cache").exit_code, 0);
  const fs::path own = *folder_ / "links/plan/ingest", victim = *folder_ / "outside/victim";
  WriteText(victim, "old");
  program::Surroundings here{"links_cache"};
  const auto task = [&] { return RunProgram(*folder_, Task("links", "ingest", 0), here).exit_code; };
  const auto as_link = [&](const fs::path& link, const fs::path& target) {
    fs::create_symlink(target, link);
    EXPECT_EQ(task(), 74) << link;
    fs::remove(link);
  };
  as_link(own, victim.parent_path());
  fs::create_directories(own);
  as_link(own / "0.jsonl", victim);
  as_link(own / "0.claim", victim);
  ASSERT_EQ(mkfifo((own / "0.claim").c_str(), 0600), 0);
  EXPECT_EQ(task(), 74);
  fs::remove(own / "0.claim");

  // Whoever knows the name of a file that asks for the clock of the folder might put a link there.
  WriteText(own / "0.claim", "another_host 1\n");
  here.before_start = [&] {
    char host[256] = {};
    gethostname(host, sizeof(host) - 1);
    fs::create_symlink(victim, own / ("0.claim.now." + std::string(host) + "." + std::to_string(getpid())));
  };
  EXPECT_EQ(task(), 2) << "at work elsewhere";
  EXPECT_EQ(ReadText(victim), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(victim.parent_path()), {}), 1);
}

TEST_F(Plans, APilotGivesTheNumberOfTasks) {
  std::vector<std::string> arguments = Arguments("plan", "pilot");
  arguments.insert(arguments.end(), {"--stage", "ingest"});
  const Result plan = RunProgram(*folder_, arguments, "pilot_cache");
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_EQ(plan.Json()["items"], 0) << "all of them are in the pilot";
  EXPECT_GT(fs::file_size(*folder_ / "pilot/journal.jsonl"), 0u);
}

TEST_F(Plans, TasksRunFromAnotherFolderThanThePlan) {
  std::vector<std::string> show = Arguments("plan", "shown");
  show.erase(show.begin(), show.begin() + 5);  // plan -o RUN --jobs 2
  show.pop_back();                             // --json
  show.insert(show.begin(), {"config", "show"});
  WriteText(*folder_ / "relative.yaml", RunProgram(*folder_, show).out);
  const auto at = [](const std::string& folder, const std::string& command) {
    const std::string line = "cd '" + (*folder_ / folder).native() + "' && MOCURATE_CACHE='" +
                             (*folder_ / "relative_cache").native() + "' " + std::string(kBinaryFolder) + "/mocurate " +
                             command + " > /dev/null 2>&1";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  EXPECT_EQ(at("", "plan relative.yaml --stage ingest --tasks 1 -o relative --set ingest.path=capture"), 0);
  fs::remove_all(*folder_ / "relative_cache");
  EXPECT_EQ(at("capture", "run --plan ../relative/plan/ingest.json --task 0"), 3) << "the plan's cache is not there";
  fs::create_directory(*folder_ / "relative_cache");
  fs::rename(*folder_ / "capture", *folder_ / "not_mounted");
  EXPECT_EQ(at("", "run --plan relative/plan/ingest.json --task 0"), 1) << "a node without the data";
  fs::rename(*folder_ / "not_mounted", *folder_ / "capture");
  EXPECT_EQ(at("capture", "run --plan ../relative/plan/ingest.json --task 0"), 0);
  EXPECT_EQ(at("", "plan --stage ingest -o synthetic"), 2) << "its capture is not made yet";
}

/// Slow: 18 programs each. Nextflow is not in Debian, and a cluster of Kubernetes is not at hand: those two are not
/// run.
TEST_F(Plans, ExamplesForOtherEnginesGiveTheBytesOfAPlainRun) {
  ASSERT_EQ(plain_.exit_code, 0) << plain_.err;
  std::vector<std::string> show = Arguments("plan", "shown");
  show.erase(show.begin(), show.begin() + 5);  // plan -o RUN --jobs 2
  show.pop_back();                             // --json
  show.insert(show.begin(), {"config", "show"});
  const Result config = RunProgram(*folder_, show);
  ASSERT_EQ(config.exit_code, 0) << config.err;
  WriteText(*folder_ / "small.yaml", config.out);
  // The run folder's name is a command to a shell that takes it for one.
  const auto engine = [](const std::string& name, const std::string& command) {
    const std::string line = "cd '" + folder_->path().native() + "' && PATH='" + std::string(kBinaryFolder) +
                             "':\"$PATH\" MOCURATE_CACHE=" + name + "_cache HOME=$PWD " + command + " > " + name +
                             ".log 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << ReadText(*folder_ / (name + ".log"));
    EXPECT_EQ(ReadText(*folder_ / (name + ";touch PWN;x") / "dataset.h5"), ReadText(*folder_ / "plain/dataset.h5"));
    EXPECT_FALSE(fs::exists(*folder_ / "PWN")) << name;
  };
  const std::string examples = std::string(kSourceFolder) + "/examples/";
  engine("parallel", "sh " + examples + "gnu_parallel/run.sh small.yaml 'parallel;touch PWN;x' 2");
  engine("snakemake", "snakemake -q -s " + examples +
                          "snakemake/Snakefile -j 2 --config job=small.yaml 'run=snakemake;touch PWN;x' tasks=2");
}

}  // namespace
}  // namespace mocurate
