// Output that cannot be written: exit code 74, a message with place and remedy, and a run that continues
// once there is space.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/stat.h>

#include "tests/app/disk.h"

namespace mocurate {
namespace {

using program::FromCache;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::Surroundings;
using program::TightDisk;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr std::size_t kLargestFile = 380000;  // the dataset of the small job is larger, all else is smaller

std::vector<std::string> JsonJob(const ScratchFolder& folder, const std::string& output) {
  std::vector<std::string> arguments = SmallJob(folder, output);
  arguments.emplace_back("--json");
  return arguments;
}

/// Runs the small job on a `disk` that is too small, then with enough space.
void ExpectEndAndContinuation(const ScratchFolder& folder, TightDisk& disk, const std::string& run,
                              const std::string& cache) {
  const Result full = RunProgram(folder, JsonJob(folder, run), Surroundings{cache, disk.Limit()});
  ASSERT_EQ(full.exit_code, 74) << full.out << full.err;
  const nlohmann::json error = full.Json()["error"];
  EXPECT_EQ(error["code"], "cannot_write") << error;
  EXPECT_EQ(error["exit_code"], 74);
  EXPECT_THAT(error["what"].get<std::string>(), AnyOf(HasSubstr("No space left on device"), HasSubstr("too large")));
  EXPECT_THAT(error["where"].get<std::string>(), HasSubstr(disk.path().native()));
  EXPECT_THAT(error["hint"].get<std::string>(), HasSubstr("space"));
  EXPECT_THAT(full.err, HasSubstr(disk.path().native()));

  ASSERT_TRUE(disk.Grow());
  const Result roomy = RunProgram(folder, JsonJob(folder, run), Surroundings{cache, disk.Limit()});
  ASSERT_EQ(roomy.exit_code, 0) << roomy.err;
  EXPECT_GT(FromCache(roomy.Json()), 0);
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "calm"), program::SharedCache()).exit_code, 0);
  EXPECT_TRUE(ReadText(folder / "calm/dataset.h5") == ReadText(folder / (run + "/dataset.h5")));
}

TEST(FullDisk, UnderTheCacheEndsWith74AndTheRunContinuesWithSpace) {
  const ScratchFolder folder;
  TightDisk disk(folder / "small", 1500000, kLargestFile);
  ExpectEndAndContinuation(folder, disk, "r", disk.path().native());
}

TEST(FullDisk, UnderTheRunFolderEndsWith74AndTheRunContinuesWithSpace) {
  const ScratchFolder folder;
  TightDisk disk(folder / "small", 600000, kLargestFile);
  ExpectEndAndContinuation(folder, disk, disk.path().native(), "small/cache_elsewhere");
}

/// Drops root's capabilities to write everywhere.
void GiveUpOverridingPermissions() {
  if (geteuid() != 0) return;
  prctl(PR_CAPBSET_DROP, 1);  // CAP_DAC_OVERRIDE
  prctl(PR_CAPBSET_DROP, 2);  // CAP_DAC_READ_SEARCH
}

TEST(ReadOnlyFolder, ForTheRunOrTheCacheEndsWith74AndNamesIt) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "locked");
  ASSERT_EQ(chmod((folder / "locked").c_str(), 0555), 0);
  for (const bool run_folder : {true, false}) {
    const Result result = RunProgram(folder, JsonJob(folder, run_folder ? "locked/r" : "r"),
                                     Surroundings{run_folder ? "cache" : "locked/cache", GiveUpOverridingPermissions});
    EXPECT_EQ(result.exit_code, 74) << result.out << result.err;
    const nlohmann::json error = result.Json()["error"];
    EXPECT_EQ(error["code"], "cannot_write");
    EXPECT_THAT(error["where"].get<std::string>(), HasSubstr((folder / "locked").native()));
    EXPECT_THAT(error["what"].get<std::string>(), HasSubstr("Permission denied"));
    EXPECT_NE(error["hint"], "");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder / "locked"));
}

}  // namespace
}  // namespace mocurate
