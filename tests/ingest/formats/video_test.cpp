// What the header of a video says.

#include "ingest/sources/video.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/file.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

/// 30 frames of 64 x 48 at 25 Hz that become red.
std::filesystem::path Reddening() {
  const std::filesystem::path file = FreshFolder("video") / "red.avi";
  cv::VideoWriter writer(file.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0,
                         {64, 48});
  for (int i = 0; i < 30; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(0, 0, 8 * i)));
  return file;
}

TEST(Video, ReportsItsFramesRateAndSize) {
  const auto facts = ReadVideoFacts(Reddening());
  ASSERT_TRUE(facts) << facts.error().Message();
  EXPECT_EQ(facts->frames, 30);
  EXPECT_DOUBLE_EQ(facts->rate_hz, 25.0);
  EXPECT_EQ(facts->width, 64);
  EXPECT_EQ(facts->height, 48);
  EXPECT_EQ(facts->codec, "MJPG");
}

TEST(Video, ReportsMissingFilesAndThoseThatAreNone) {
  const std::filesystem::path folder = FreshFolder("no_video");
  ExpectError(ReadVideoFacts(folder / "none.avi"), ErrorCode::kNotFound, (folder / "none.avi").string());
  Put(folder / "text.avi", "no video at all");
  ExpectMalformed(ReadVideoFacts(folder / "text.avi"), (folder / "text.avi").string());
}

TEST(Video, ReportsPositiveFactsOrAnErrorWhenTruncated) {
  const std::filesystem::path file = Reddening();
  const std::string bytes = ReadFile(file).value();
  for (int i = 1; i < 20; ++i) {
    Put(file, bytes.substr(0, bytes.size() * static_cast<std::size_t>(i) / 20));
    const auto facts = ReadVideoFacts(file);
    if (!facts) continue;
    EXPECT_GE(facts->frames, 0);
    EXPECT_GT(facts->rate_hz, 0.0);
    EXPECT_EQ(facts->width, 64);
  }
}

}  // namespace
}  // namespace mocurate
