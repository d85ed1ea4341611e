#include "report/video/video_file.h"

#include <cmath>
#include <opencv2/videoio.hpp>
#include <utility>

namespace mocurate {
namespace {

constexpr const char* kHowToEncode =
    "OpenCV's videoio writes with FFmpeg's libavcodec, which needs libx264 (Debian: libopencv-videoio406, "
    "libavcodec59, "
    "libx264-164)";

int PicturesIn(const std::filesystem::path& file) {
  try {
    const cv::VideoCapture video(file.string(), cv::CAP_FFMPEG);
    return video.isOpened() ? static_cast<int>(std::lround(video.get(cv::CAP_PROP_FRAME_COUNT))) : 0;
  } catch (const cv::Exception&) {
    return 0;
  }
}

/// A file under a temporary name; removed unless it is completed.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path path) : path_(std::move(path)) {}
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    std::error_code unknown;
    std::filesystem::remove(path_, unknown);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

Expected<int> WriteVideo(const std::string& item, double rate_hz, int count,
                         const std::function<Expected<cv::Mat>(int)>& draw, const std::filesystem::path& file) {
  const PartialFile partial(file.string() + ".mp4");  // OpenCV chooses the container by the name
  cv::VideoWriter writer;
  for (int picture = 0; picture < count; ++picture) {
    const auto image = draw(picture);
    if (!image) return Forward(image);
    if (picture == 0) {
      try {
        writer.open(partial.path().string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), rate_hz,
                    image->size());
      } catch (const cv::Exception&) {
        // Reported below.
      }
      if (!writer.isOpened()) {
        return Fail(ErrorCode::kMissingOnHost, "no H.264 encoder: a video cannot be written", item, kHowToEncode);
      }
    }
    writer.write(*image);
  }
  writer.release();
  if (PicturesIn(partial.path()) != count) {
    return Fail(ErrorCode::kCannotWrite, "the video is incomplete", item, "check the disk space");
  }
  std::error_code problem;
  std::filesystem::rename(partial.path(), file, problem);
  if (problem) return Fail(ErrorCode::kCannotWrite, "the video cannot be written: " + problem.message(), item);
  return count;
}

}  // namespace mocurate
