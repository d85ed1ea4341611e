#include "ingest/sources/video.h"

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr int kLargestSide = 16384;
constexpr double kHighestRate = 1e5;
constexpr int kMostFrames = 1 << 30;

std::string CodecText(int code) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const int c = (code >> (8 * i)) & 0xFF;
    if (c > ' ' && c < 0x7F) text += static_cast<char>(c);
  }
  return text;
}

bool Opens(const std::filesystem::path& file, cv::VideoCapture& capture) {
  try {
    return capture.open(file.string());
  } catch (const cv::Exception&) {  // the same as not opened
    return false;
  }
}

}  // namespace

Expected<VideoFacts> ReadVideoFacts(const std::filesystem::path& file) {
  const auto bad = [&](const std::string& what) {
    return Fail(ErrorCode::kMalformed, what, DisplayPath(file), "check that the file is complete and plays");
  };
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) return Fail(ErrorCode::kNotFound, "no such file", DisplayPath(file));
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::VideoCapture capture;
  if (!Opens(file, capture)) return bad("OpenCV cannot decode the file as a video");
  const double rate = capture.get(cv::CAP_PROP_FPS), frames = capture.get(cv::CAP_PROP_FRAME_COUNT);
  const double width = capture.get(cv::CAP_PROP_FRAME_WIDTH), height = capture.get(cv::CAP_PROP_FRAME_HEIGHT);
  if (!(width >= 1 && width <= kLargestSide && height >= 1 && height <= kLargestSide)) {
    return bad("images of " + FormatDouble(width) + " x " + FormatDouble(height) + " pixels are invalid");
  }
  if (!(rate > 0.0 && rate <= kHighestRate)) return bad("a rate of " + FormatDouble(rate) + " Hz is invalid");
  VideoFacts facts;
  facts.rate_hz = rate;
  facts.width = static_cast<int>(width);
  facts.height = static_cast<int>(height);
  facts.frames = frames >= 1 && frames <= kMostFrames ? static_cast<int>(frames) : 0;
  facts.codec = CodecText(static_cast<int>(capture.get(cv::CAP_PROP_FOURCC)));
  return facts;
}

}  // namespace mocurate
