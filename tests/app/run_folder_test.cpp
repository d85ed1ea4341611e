// A run writes into folders of its job and empty ones, and removes nothing: other files with the names of outputs are
// not changed, outputs of earlier runs stay and are marked as stale.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SharedCache;
using program::SmallJob;
using program::Surroundings;
using program::WriteText;
using ::testing::HasSubstr;

/// Every file below a folder with its bytes.
std::map<std::string, std::string> FilesOf(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[entry.path().lexically_relative(folder).string()] = ReadText(entry.path());
  }
  return files;
}

std::vector<std::string> IngestOnly(const ScratchFolder& folder, const std::string& output) {
  std::vector<std::string> arguments = SmallJob(folder, output);
  std::replace(arguments.begin(), arguments.end(), std::string("assemble"), std::string("ingest"));
  return arguments;
}

TEST(RunFolder, AFolderOfOthersWithAFileOfOurNameIsRefusedUnchanged) {
  for (const char* name :
       {"dataset.h5", "metrics.json", "tables/table.csv", "report/index.html", "checkpoints/recogniser_3.h5",
        "curation_log.jsonl", "run.json", "journal.jsonl", "lock", "capture.json"}) {
    const ScratchFolder folder;
    WriteText(folder / ("mine/" + std::string(name)), "{\"mine\": true}");
    WriteText(folder / "mine/notes.txt", "mine");
    const auto before = FilesOf(folder / "mine");
    std::vector<std::string> arguments = IngestOnly(folder, "mine");
    arguments.emplace_back("--json");
    const Result result = RunProgram(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << name << result.err;
    EXPECT_THAT(result.err, HasSubstr((folder / ("mine/" + std::string(name))).string()));
    EXPECT_THAT(result.err, HasSubstr("choose another folder with -o"));
    EXPECT_EQ(FilesOf(folder / "mine"), before) << name;
  }
}

TEST(RunFolder, TheCurrentFolderFollowsTheSameRule) {
  const ScratchFolder folder;
  WriteText(folder / "mine/metrics.json", "mine");
  fs::create_directories(folder / "empty");
  for (const bool empty : {false, true}) {
    std::vector<std::string> arguments = IngestOnly(folder, "r");
    arguments[2] = ".";
    Surroundings there;
    there.before_start = [&folder, empty] {
      if (chdir((folder / (empty ? "empty" : "mine")).c_str()) != 0) _exit(1);
    };
    const Result result = RunProgram(folder, arguments, there);
    EXPECT_EQ(result.exit_code, empty ? 0 : 2) << result.err;
  }
  EXPECT_EQ(FilesOf(folder / "mine"), (std::map<std::string, std::string>{{"metrics.json", "mine"}}));
  EXPECT_TRUE(fs::exists(folder / "empty/run.json"));
}

TEST(RunFolder, OtherFilesOfAFolderAreAllowedAndStay) {
  const ScratchFolder folder;
  WriteText(folder / "mine/notes.txt", "mine");
  WriteText(folder / "mine/lock", "");  // a run that was killed before its run.json was there
  WriteText(folder / "mine/journal.jsonl", "");
  for (int i = 0; i < 2; ++i) {
    const Result result = RunProgram(folder, IngestOnly(folder, "mine"));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(ReadText(folder / "mine/notes.txt"), "mine");
  }
}

nlohmann::json StaleOf(const fs::path& run) { return nlohmann::json::parse(ReadText(run / "run.json")).at("stale"); }

TEST(RunFolder, LaterStagesStayAndAreStaleUntilTheyAreMadeAgain) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "r"), SharedCache()).exit_code, 0);
  EXPECT_EQ(StaleOf(folder / "r"), nlohmann::json::array());
  const std::string dataset = ReadText(folder / "r/dataset.h5");
  std::vector<std::string> changed = IngestOnly(folder, "r");
  changed.insert(changed.end(), {"--set", "canon.facing.anchor=last"});
  const nlohmann::json stale = nlohmann::json::array({{{"file", "dataset.h5"}, {"stage", "assemble"}}});
  for (int i = 0; i < 2; ++i) {
    const Result shorter = RunProgram(folder, changed, SharedCache());
    ASSERT_EQ(shorter.exit_code, 0) << shorter.err;
    EXPECT_THAT(shorter.err, HasSubstr("dataset.h5 (assemble)"));
    EXPECT_EQ(ReadText(folder / "r/dataset.h5"), dataset);
    EXPECT_EQ(StaleOf(folder / "r"), stale);
  }
  const nlohmann::json json = RunProgram(folder, {"inspect", (folder / "r").string(), "--json"}).Json();
  EXPECT_EQ(json["stale"], stale);
  EXPECT_EQ(json["files"], nlohmann::json({"curation_log.jsonl"}));
  EXPECT_THAT(RunProgram(folder, {"inspect", (folder / "r").string()}).out, HasSubstr("dataset.h5 (assemble)"));
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "r"), SharedCache()).exit_code, 0);
  EXPECT_EQ(StaleOf(folder / "r"), nlohmann::json::array());
  EXPECT_EQ(ReadText(folder / "r/dataset.h5"), dataset);
}

TEST(RunFolder, AFolderOfAnotherJobOrConfigurationFileIsRefusedUnlessReplaced) {
  const ScratchFolder folder;
  for (const char* file : {"a.yaml", "b.yaml"}) WriteText(folder / file, "include: resource:demo.yaml\n");
  const auto run = [&](const std::string& config, const std::vector<std::string>& more = {}, bool whole = false) {
    std::vector<std::string> arguments = whole ? SmallJob(folder, "r") : IngestOnly(folder, "r");
    if (!config.empty()) arguments.insert(arguments.begin() + 1, config);
    arguments.insert(arguments.end(), more.begin(), more.end());
    Surroundings there{SharedCache()};
    there.before_start = [&folder] {
      if (chdir(folder.path().c_str()) != 0) _exit(1);
    };
    return RunProgram(folder, arguments, there);
  };
  const std::string a = (folder / "a.yaml").string(), b = (folder / "b.yaml").string();
  ASSERT_EQ(run(a, {}, true).exit_code, 0);
  EXPECT_EQ(run("./a.yaml", {"--set", "canon.facing.anchor=last"}, true).exit_code, 0)
      << "the same file, another option";
  fs::create_symlink(a, folder / "link.yaml");
  EXPECT_EQ(run("link.yaml", {}, true).exit_code, 0) << "the same file, another path";
  EXPECT_EQ(run(a, {}, true).exit_code, 0);
  const auto before = FilesOf(folder / "r");
  const std::pair<std::string, std::vector<std::string>> others[] = {
      {b, {}}, {"", {}}, {a, {"--set", "name=other"}}, {b, {"--dry-run"}}};
  for (const auto& [config, more] : others) {
    const Result refused = run(config, more);
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr(a));
    EXPECT_THAT(refused.err, HasSubstr("--replace"));
    EXPECT_EQ(FilesOf(folder / "r"), before);
  }
  EXPECT_EQ(RunProgram(folder, {"plan", b, "--stage", "ingest", "-o", (folder / "r").string()}).exit_code, 2);
  EXPECT_EQ(RunProgram(folder, {"reproduce", "a2m/table5", "-o", (folder / "r").string()}).exit_code, 2);
  EXPECT_EQ(FilesOf(folder / "r"), before);

  const Result replaced = run(b, {"--replace"});
  EXPECT_EQ(replaced.exit_code, 0) << replaced.err;
  EXPECT_EQ(ReadText(folder / "r/dataset.h5"), before.at("dataset.h5"));
  EXPECT_EQ(StaleOf(folder / "r"), nlohmann::json::array({{{"file", "dataset.h5"}, {"stage", "assemble"}}}));
  EXPECT_EQ(run(b).exit_code, 0) << "the folder is b's now";
  EXPECT_EQ(run(a).exit_code, 2);
}

/// A run folder of somebody else, in which a name of an output is a link.
TEST(RunFolder, NothingIsWrittenThroughALinkInIt) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "sent"), SharedCache()).exit_code, 0);
  WriteText(folder / "outside/victim", "old");
  const auto before = FilesOf(folder / "outside");
  const std::string run = (folder / "r").string();
  const auto refuses = [&](const std::string& name, const fs::path& target, const std::vector<std::string>& command) {
    fs::remove_all(run);
    fs::copy(folder / "sent", run, fs::copy_options::recursive);
    fs::remove_all(folder / "r" / name);
    fs::create_directories((folder / "r" / name).parent_path());
    fs::create_symlink(target, folder / "r" / name);
    const Result result = RunProgram(folder, command);
    EXPECT_EQ(result.exit_code, 74) << command.front() << ", link " << name << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr((folder / "r" / name).string()));
    EXPECT_EQ(FilesOf(folder / "outside"), before) << name;
  };
  for (const char* name :
       {"lock", "journal.jsonl", "run.json", "curation_log.jsonl", "dataset.h5", "metrics.json", "capture.json",
        "set_findings.json", "report_input.json", "time_budget.json", "checkpoints/gru_1.h5", "tables/table.md",
        "report/index.html", "plan/ingest.json", "slurm/jobs.jsonl"}) {
    for (const char* target : {"outside/victim", "outside/none"}) {
      refuses(name, folder / target, SmallJob(folder, "r"));
    }
  }
  std::vector<std::string> plan = SmallJob(folder, "r");
  plan.front() = "plan";
  plan[3] = "--stage", plan[4] = "ingest";
  const std::vector<std::string> reproduce = {"reproduce", "a2m/table3", "-o", run};
  for (const char* name : {"checkpoints", "tables", "report", "plan", "plan/ingest", "slurm"}) {
    refuses(name, folder / "outside", SmallJob(folder, "r"));
    refuses(name, folder / "outside", plan);
    refuses(name, folder / "outside", reproduce);
  }
  refuses("capture", folder / "outside", SmallJob(folder, "r"));
  for (const char* name : {"data", "data/humanact12"}) refuses(name, folder / "outside", reproduce);
}

TEST(RunFolder, APipeInsteadOfAFileIsRefused) {
  const ScratchFolder folder;
  fs::create_directories(folder / "r");
  for (const char* name : {"lock", "journal.jsonl", "run.json"}) {
    ASSERT_EQ(mkfifo((folder / "r" / name).c_str(), 0600), 0);
    EXPECT_EQ(RunProgram(folder, IngestOnly(folder, "r")).exit_code, 74) << name;
    fs::remove(folder / "r" / name);
  }
}

TEST(RunFolder, MayBeALinkAndHoldLinksOfOtherNames) {
  const ScratchFolder folder;
  fs::create_directories(folder / "disk/r");
  fs::create_directory_symlink(folder / "disk", folder / "runs");
  WriteText(folder / "notes.txt", "mine");
  fs::create_symlink(folder / "notes.txt", folder / "disk/r/notes.txt");
  fs::create_directory_symlink(folder / "disk/r", folder / "direct");
  EXPECT_EQ(RunProgram(folder, IngestOnly(folder, "runs/r")).exit_code, 0);
  const Result again = RunProgram(folder, IngestOnly(folder, "direct"));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(fs::exists(folder / "disk/r/run.json"));
  EXPECT_EQ(ReadText(folder / "notes.txt"), "mine");
}

TEST(RunFolder, ANameThatIsAPathIsRefused) {
  const ScratchFolder folder;
  Surroundings there;
  there.before_start = [&folder] {
    if (chdir(folder.path().c_str()) != 0) _exit(1);
  };
  for (const char* name : {"../out", "/tmp/out", "..", ".", "a/b", "\"\""}) {
    const Result result = RunProgram(folder, {"run", "--set", "name=" + std::string(name), "--to", "ingest"}, there);
    EXPECT_EQ(result.exit_code, 2) << name << result.err;
    EXPECT_THAT(result.err, HasSubstr("name the run folder with -o DIR")) << name;
  }
  const Result empty = RunProgram(folder, {"run", "-o", "", "--to", "ingest"}, there);
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err, HasSubstr("-o: the run folder is an empty text"));
  EXPECT_FALSE(fs::exists(folder / "runs"));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace mocurate
