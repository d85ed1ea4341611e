// Bad input through the whole program: the message names file, place, value and way out, and the exit code is the
// documented one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::Folder;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::HasSubstr;

constexpr const char* kTable = R"(name: bad
skeleton: openni16
ingest:
  path: data
  source:
    name: bad
    format: joint_table
    files: "a{action}_s{person}.txt"
    UNITS
    axes: "+x +y -z"
    rate: 30 Hz
    skeleton: openni15
    rows_per_frame: ROWS
    joints: [JOINTS]
)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}

std::string TableConfig(const std::string& units, const std::string& rows, const std::string& joints) {
  return Replaced(Replaced(Replaced(kTable, "UNITS", units), "ROWS", rows), "JOINTS", joints);
}

Result RunFolder(const Folder& folder, const std::string& config) {
  WriteText(folder / "job.yaml", config);
  return RunProgram(folder,
                    {"run", (folder / "job.yaml").string(), "-o", (folder / "run").string(), "--to", "assemble"});
}

std::string Rows(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "100 " + std::to_string(100 * i) + " 2000\n";
  return text;
}

TEST(BadInput, ARowCountThatDoesNotDivideNamesFileAndCounts) {
  const Folder folder;
  WriteText(folder / "data/a01_s01.txt", Rows(7));
  const Result result = RunFolder(folder, TableConfig("units: mm", "3", "head, neck, torso"));
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("a01_s01"));
  EXPECT_THAT(result.err, HasSubstr("7"));
}

TEST(BadInput, AMissingUnitIsAConfigError) {
  const Folder folder;
  WriteText(folder / "data/a01_s01.txt", Rows(6));
  const Result result = RunFolder(folder, TableConfig("licence: none", "3", "head, neck, torso"));
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr("units"));
}

TEST(BadInput, AnUnknownJointIsNamed) {
  const Folder folder;
  WriteText(folder / "data/a01_s01.txt", Rows(6));
  const Result result = RunFolder(folder, TableConfig("units: mm", "3", "head, neck, third_elbow"));
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("third_elbow"));
}

TEST(BadInput, AFileNameOutsideThePatternIsSaid) {
  const Folder folder;
  WriteText(folder / "data/walk.txt", Rows(6));
  const Result result = RunFolder(folder, TableConfig("units: mm", "3", "head, neck, torso"));
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("walk.txt"));
}

TEST(BadInput, ATruncatedOrBrokenBvhIsAnErrorWithItsLine) {
  const Folder folder;
  const std::string head =
      "HIERARCHY\nROOT a\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n}\nMOTION\n";
  WriteText(folder / "cut.bvh", head + "Frames: 3\nFrame Time: 0.033\n0 0 0\n");
  const Result cut = RunProgram(folder, {"inspect", (folder / "cut.bvh").string()});
  EXPECT_EQ(cut.exit_code, 3) << cut.out << cut.err;
  WriteText(folder / "nan.bvh", head + "Frames: 1\nFrame Time: 0.033\n0 nan 0\n");
  const Result nan = RunProgram(folder, {"inspect", (folder / "nan.bvh").string()});
  EXPECT_EQ(nan.exit_code, 3) << nan.out << nan.err;
  EXPECT_THAT(nan.err, HasSubstr("nan"));
}

TEST(BadInput, ACorruptedStoreIsAnErrorThatNamesTheField) {
  const Folder folder;
  ASSERT_EQ(RunProgram(folder, program::SmallJob(folder, "r")).exit_code, 0);
  std::string bytes = ReadText(folder / "r/dataset.h5");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  WriteText(folder / "broken.h5", bytes);
  const Result result = RunProgram(folder, {"inspect", (folder / "broken.h5").string()});
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_THAT(result.err, HasSubstr("broken.h5"));
}

}  // namespace
}  // namespace mocurate
