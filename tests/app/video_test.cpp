// `mocurate inspect` describes videos without linking a decoder.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "job/run_and_capture.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;

void WriteVideo(const std::filesystem::path& file) {
  cv::VideoWriter writer(file.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12.0,
                         {64, 48});
  for (int i = 0; i < 24; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(8 * i, 0, 0)));
}

TEST(InspectVideo, ReportsFramesRateAndSize) {
  const ScratchFolder folder;
  WriteVideo(folder / "a.avi");
  const Result result = RunProgram(folder, {"inspect", (folder / "a.avi").string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json document = result.Json();
  EXPECT_EQ(document["format"], "video");
  const nlohmann::json wanted = {{"frames", 24}, {"rate_hz", 12.0},   {"width", 64},
                                 {"height", 48}, {"duration_s", 2.0}, {"codec", "MJPG"}};
  EXPECT_EQ(document["companions"][0]["facts"], wanted);
  EXPECT_TRUE(document["findings"].empty());
}

TEST(InspectVideo, ADamagedOneIsAFindingAndDoesNotAffectOthers) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "set");
  WriteVideo(folder / "set/a.avi");
  WriteText(folder / "set/b.avi", ReadText(folder / "set/a.avi").substr(0, 100));
  WriteVideo(folder / "set/c.avi");
  const nlohmann::json document = RunProgram(folder, {"inspect", (folder / "set").string(), "--json"}).Json();
  ASSERT_EQ(document["companions"].size(), 2u) << document;
  EXPECT_EQ(document["companions"][1]["file"], "c.avi");
  ASSERT_EQ(document["findings"].size(), 1u) << document;
  EXPECT_EQ(document["findings"][0]["code"], "malformed");
  EXPECT_THAT(document["findings"][0]["where"].get<std::string>(), ::testing::HasSubstr("b.avi"));
}

/// The program with a script as its decoder: what it answers of videos a.avi, b.avi, ...
nlohmann::json InspectedBy(const ScratchFolder& folder, const std::string& script) {
  namespace fs = std::filesystem;
  fs::create_directories(folder / "bin");
  fs::copy_file(fs::path(kBinaryFolder) / "mocurate", folder / "bin/mocurate");
  WriteText(folder / "bin/mocurate-video", "#!/bin/sh\n" + script);
  fs::permissions(folder / "bin/mocurate-video", fs::perms::owner_all);
  fs::create_directories(folder / "set");
  for (const char* name : {"a.avi", "b.avi", "c.avi"}) WriteVideo(folder / "set" / name);
  program::Surroundings surroundings;
  surroundings.program = folder / "bin/mocurate";
  surroundings.before_start = [] { setenv("LC_ALL", "en_US.UTF-8", 1); };
  return RunProgram(folder, {"inspect", (folder / "set").string(), "--json"}, surroundings).Json();
}

TEST(InspectVideo, AnswersAreAssignedByIndexWhateverElseIsPrinted) {
  const ScratchFolder folder;
  const nlohmann::json document =
      InspectedBy(folder,
                  "echo '{\"index\": 0, \"frames\": 99}' >&2\n"
                  "echo '{\"frames\": 98}'\n"
                  "echo '{\"index\": 7, \"frames\": 97}'\n"
                  "echo 'a library greets'\n"
                  "for i in 2 0 1; do echo \"{\\\"index\\\": $i, \\\"frames\\\": 1$i}\"; done\n");
  ASSERT_EQ(document["companions"].size(), 3u) << document;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(document["companions"][i]["facts"]["frames"], 10 + i) << document["companions"][i];
  }
}

TEST(InspectVideo, TheDecoderRunsInTheNeutralLocale) {
  const ScratchFolder folder;
  const nlohmann::json document = InspectedBy(
      folder,
      "locale=$(tr '\\0' '\\n' < /proc/$$/environ | grep ^LC_ALL= | tr '\\n' ' ')\n"
      "for i in 0 1 2; do echo \"{\\\"index\\\": $i, \\\"frames\\\": 1, \\\"codec\\\": \\\"$locale\\\"}\"; done\n");
  ASSERT_EQ(document["companions"].size(), 3u) << document;
  EXPECT_EQ(document["companions"][0]["facts"]["codec"], "LC_ALL=C ");
}

TEST(RunAndCapture, EndsAProgramWithoutOutputForTooLong) {
  const ProgramAnswer answer =
      RunAndCapture("/bin/sh", {"-c", "echo first; exec sleep 1000"}, CaptureOptions{true, 0.5});
  EXPECT_TRUE(answer.timed_out);
  EXPECT_EQ(answer.exit_status, -1);
}

TEST(RunAndCapture, ReadsErrorsOnlyIfRequested) {
  const std::vector<std::string> both = {"-c", "echo out; echo err >&2; exit 3"};
  EXPECT_EQ(RunAndCapture("/bin/sh", both).text, "out\nerr\n");
  const ProgramAnswer answer = RunAndCapture("/bin/sh", both, CaptureOptions{false, 600.0});
  EXPECT_EQ(answer.text, "out\n");
  EXPECT_EQ(answer.exit_status, 3);
  EXPECT_FALSE(answer.timed_out);
}

}  // namespace
}  // namespace mocurate
