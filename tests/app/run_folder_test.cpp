// A run writes into run folders and empty ones: other files with the names of outputs are not changed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
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
