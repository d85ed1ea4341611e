// `mocurate inspect` tells of videos without linking what decodes them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::Folder;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;

void WriteVideo(const std::filesystem::path& file) {
  cv::VideoWriter writer(file.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12.0,
                         {64, 48});
  for (int i = 0; i < 24; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(8 * i, 0, 0)));
}

TEST(InspectVideo, SaysFramesRateAndSize) {
  const Folder folder;
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

TEST(InspectVideo, ADamagedOneIsAFindingAndCostsTheOthersNothing) {
  const Folder folder;
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

}  // namespace
}  // namespace mocurate
