// Damaged objects of the cache cost time, not clips: they are detected and computed again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::WriteText;
using ::testing::HasSubstr;

/// One person's five clips.
std::vector<std::string> OnePersonsJob(const ScratchFolder& folder) {
  std::vector<std::string> arguments = SmallJob(folder, "r");
  std::replace(arguments.begin(), arguments.end(), std::string("ingest.synthetic.subjects=3"),
               std::string("ingest.synthetic.subjects=1"));
  return arguments;
}

std::vector<std::string> UpTo(const ScratchFolder& folder, const std::string& stage) {
  std::vector<std::string> arguments = OnePersonsJob(folder);
  std::replace(arguments.begin(), arguments.end(), std::string("assemble"), stage);
  return arguments;
}

/// Overwrites the middle of every HDF5 object that `chosen` wants; their sizes stay. How many.
int Damage(const ScratchFolder& folder, const std::function<bool(const std::string& bytes)>& chosen) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "cache/objects")) {
    if (entry.path().extension() != ".h5") continue;
    std::string bytes = ReadText(entry.path());
    if (!chosen(bytes)) continue;
    bytes.replace(bytes.size() / 4, bytes.size() / 2, std::string(bytes.size() / 2, '\x55'));
    WriteText(entry.path(), bytes);
    ++count;
  }
  return count;
}

TEST(DamagedCache, OutputsOfEarlierStagesAreRecomputedInTheSameRun) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, OnePersonsJob(folder)).exit_code, 0);
  const std::string dataset = ReadText(folder / "r/dataset.h5");
  fs::remove_all(folder / "cache");

  ASSERT_EQ(RunProgram(folder, UpTo(folder, "fitting")).exit_code, 0);
  EXPECT_GE(Damage(folder, [](const std::string&) { return true; }), 10) << "five clips of evidence, five fits";
  const Result repeated = RunProgram(folder, OnePersonsJob(folder));
  EXPECT_EQ(repeated.exit_code, 0) << repeated.out << repeated.err;
  EXPECT_THAT(repeated.err, HasSubstr("does not hold the bytes that were recorded: made again"));
  EXPECT_THAT(repeated.out, HasSubstr("5 clips, 5 kept"));
  EXPECT_TRUE(ReadText(folder / "r/dataset.h5") == dataset) << "other bytes";
  EXPECT_EQ(RunProgram(folder, OnePersonsJob(folder)).exit_code, 0) << "no refusal was kept";
}

TEST(DamagedCache, ADatasetIsNotCopiedIntoTheRunFolderWithoutALookAtItsBytes) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, OnePersonsJob(folder)).exit_code, 0);
  const std::string dataset = ReadText(folder / "r/dataset.h5");
  EXPECT_EQ(Damage(folder, [&](const std::string& bytes) { return bytes == dataset; }), 1);
  const Result repeated = RunProgram(folder, OnePersonsJob(folder));
  EXPECT_EQ(repeated.exit_code, 0) << repeated.out << repeated.err;
  EXPECT_TRUE(ReadText(folder / "r/dataset.h5") == dataset) << "other bytes";
}

}  // namespace
}  // namespace mocurate
