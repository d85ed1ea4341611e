#include "ingest/sources/video.h"

#include <cmath>
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
constexpr double kRounding = 1e-6;  // of a frame: 0.04 s at 25 Hz is frame 1

std::string CodecText(int code) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const int c = (code >> (8 * i)) & 0xFF;
    if (c > ' ' && c < 0x7F) text += static_cast<char>(c);
  }
  return text;
}

}  // namespace

struct VideoReader::Decoder {
  std::filesystem::path file;
  cv::VideoCapture capture;
  VideoFacts facts;
  int next = 0;  ///< index of the frame decoded next

  tl::unexpected<Error> Bad(const std::string& what) const {
    return Fail(ErrorCode::kMalformed, what, DisplayPath(file), "check that the file is complete and plays");
  }

  Status Begin() {
    next = 0;
    try {
      if (capture.open(file.string())) return {};
    } catch (const cv::Exception&) {  // the same as not opened
    }
    return Bad("OpenCV cannot decode the file as a video");
  }

  Status ReadFacts() {
    const double rate = capture.get(cv::CAP_PROP_FPS), frames = capture.get(cv::CAP_PROP_FRAME_COUNT);
    const double width = capture.get(cv::CAP_PROP_FRAME_WIDTH), height = capture.get(cv::CAP_PROP_FRAME_HEIGHT);
    if (!(width >= 1 && width <= kLargestSide && height >= 1 && height <= kLargestSide)) {
      return Bad("images of " + FormatDouble(width) + " x " + FormatDouble(height) + " pixels are invalid");
    }
    if (!(rate > 0.0 && rate <= kHighestRate)) return Bad("a rate of " + FormatDouble(rate) + " Hz is invalid");
    facts.rate_hz = rate;
    facts.width = static_cast<int>(width);
    facts.height = static_cast<int>(height);
    facts.frames = frames >= 1 && frames <= kMostFrames ? static_cast<int>(frames) : 0;
    facts.codec = CodecText(static_cast<int>(capture.get(cv::CAP_PROP_FOURCC)));
    return {};
  }

  Expected<ColourFrame> Decode(int index) {
    if (index < next) {
      if (Status begun = Begin(); !begun) return Forward(begun);
    }
    for (; next <= index; ++next) {
      if (capture.grab()) continue;
      return Fail(
          ErrorCode::kNotFound,
          "frame " + std::to_string(index) + " does not exist, the file ends after " + std::to_string(next) + " frames",
          DisplayPath(file));
    }
    cv::Mat image;
    if (!capture.retrieve(image) || image.type() != CV_8UC3 || !image.isContinuous()) {
      return Bad("frame " + std::to_string(index) + " cannot be decoded");
    }
    ColourFrame frame{image.cols, image.rows, {image.datastart, image.dataend}};
    for (std::size_t i = 0; i + 2 < frame.rgb.size(); i += 3) std::swap(frame.rgb[i], frame.rgb[i + 2]);
    return frame;
  }
};

VideoReader::VideoReader() : decoder_(std::make_unique<Decoder>()) {}
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;
VideoReader::~VideoReader() = default;

Expected<VideoReader> VideoReader::Open(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) {
    return Fail(ErrorCode::kNotFound, "no such file", DisplayPath(file));
  }
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  VideoReader reader;
  reader.decoder_->file = file;
  if (Status begun = reader.decoder_->Begin(); !begun) return Forward(begun);
  if (Status read = reader.decoder_->ReadFacts(); !read) return Forward(read);
  return reader;
}

const VideoFacts& VideoReader::facts() const { return decoder_->facts; }

Expected<ColourFrame> VideoReader::Frame(int index) {
  if (index < 0) return Fail(ErrorCode::kNotFound, "frames are counted from 0", DisplayPath(decoder_->file));
  try {
    return decoder_->Decode(index);
  } catch (const cv::Exception& exception) {
    return decoder_->Bad("frame " + std::to_string(index) + " cannot be decoded: " + exception.err);
  }
}

Expected<ColourFrame> VideoReader::FrameAt(double seconds) {
  const double frame = std::floor(seconds * decoder_->facts.rate_hz + kRounding);
  if (!(frame >= 0.0 && frame <= kMostFrames)) {
    return Fail(ErrorCode::kNotFound, FormatDouble(seconds) + " s is outside the video", DisplayPath(decoder_->file));
  }
  return Frame(static_cast<int>(frame));
}

}  // namespace mocurate
