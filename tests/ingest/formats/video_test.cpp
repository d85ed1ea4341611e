// Frames of a video by number and by time.

#include "ingest/sources/video.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/file.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

/// 30 frames of 64 x 48 at 25 Hz; the red value of frame i is 8 i.
std::filesystem::path Reddening() {
  const std::filesystem::path file = FreshFolder("video") / "red.avi";
  cv::VideoWriter writer(file.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0,
                         {64, 48});
  for (int i = 0; i < 30; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(0, 0, 8 * i)));
  return file;
}

double Red(const ColourFrame& frame) {
  double sum = 0.0;
  for (std::size_t i = 0; i < frame.rgb.size(); i += 3) sum += frame.rgb[i];
  return sum / (static_cast<double>(frame.rgb.size()) / 3.0);
}

TEST(Video, ReportsItsFramesRateAndSize) {
  const auto video = VideoReader::Open(Reddening());
  ASSERT_TRUE(video) << video.error().Message();
  EXPECT_EQ(video->facts().frames, 30);
  EXPECT_DOUBLE_EQ(video->facts().rate_hz, 25.0);
  EXPECT_EQ(video->facts().width, 64);
  EXPECT_EQ(video->facts().height, 48);
  EXPECT_EQ(video->facts().codec, "MJPG");
}

TEST(Video, ReturnsFramesByNumberInAnyOrderAndByTime) {
  auto video = VideoReader::Open(Reddening());
  ASSERT_TRUE(video) << video.error().Message();
  for (const int index : {3, 4, 20, 7, 7, 0, 29}) {
    const auto frame = video->Frame(index);
    ASSERT_TRUE(frame) << frame.error().Message();
    EXPECT_EQ(frame->width, 64);
    EXPECT_EQ(frame->rgb.size(), 64u * 48u * 3u);
    EXPECT_NEAR(Red(*frame), 8.0 * index, 3.0) << index;
    EXPECT_LT(frame->rgb[2], 40) << "blue";
  }
  EXPECT_NEAR(Red(video->FrameAt(0.48).value()), 8.0 * 12, 3.0);
  EXPECT_NEAR(Red(video->FrameAt(0.519).value()), 8.0 * 12, 3.0);
}

TEST(Video, ReportsMissingFramesAndFiles) {
  const std::filesystem::path file = Reddening();
  auto video = VideoReader::Open(file);
  ExpectError(video->Frame(30), ErrorCode::kNotFound, file.string());
  EXPECT_TRUE(video->Frame(29)) << "the reader can seek back from the end";
  EXPECT_FALSE(video->Frame(-1));
  ExpectError(video->FrameAt(-0.1), ErrorCode::kNotFound, file.string());
  EXPECT_EQ(VideoReader::Open(file.parent_path() / "none.avi").error().code, ErrorCode::kNotFound);
  Put(file.parent_path() / "text.avi", "no video at all");
  ExpectMalformed(VideoReader::Open(file.parent_path() / "text.avi"), (file.parent_path() / "text.avi").string());
}

TEST(Video, ReturnsWholeFramesOrAnErrorWhenTruncated) {
  const std::filesystem::path file = Reddening();
  const std::string bytes = ReadFile(file).value();
  for (int i = 1; i < 20; ++i) {
    Put(file, bytes.substr(0, bytes.size() * static_cast<std::size_t>(i) / 20));
    auto video = VideoReader::Open(file);
    for (int f = 0; video && f < 31; ++f) {
      const auto frame = video->Frame(f);
      if (!frame) break;
      EXPECT_EQ(frame->rgb.size(), 64u * 48u * 3u);
      EXPECT_LT(f, 30);
    }
  }
}

}  // namespace
}  // namespace mocurate
