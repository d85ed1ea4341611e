#include "ingest/sources/depth_pixels.h"

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

namespace mocurate {
namespace {

constexpr std::string_view kPngBegin = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegBegin = "\xFF\xD8\xFF";
constexpr std::string_view kJpegEnd = "\xFF\xD9";
constexpr std::size_t kMostPadding = 64;
constexpr std::size_t kMaxSide = 16384;

bool BeginsWith(std::string_view bytes, std::string_view begin) { return bytes.substr(0, begin.size()) == begin; }

/// CRC-32 of a chunk, as PNG defines it; the decoder only warns of a wrong one.
std::uint32_t Crc(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

std::uint32_t BigEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char c : bytes.substr(0, 4)) value = (value << 8) | static_cast<unsigned char>(c);
  return value;
}

/// Every chunk whole, with its checksum, up to the end; what is wrong, empty if nothing.
std::string PngFault(std::string_view bytes) {
  if (bytes.size() < 33) return "the file is cut off";
  if (BigEndian(bytes.substr(16)) > kMaxSide || BigEndian(bytes.substr(20)) > kMaxSide) return "the image is too large";
  std::size_t at = kPngBegin.size();
  while (bytes.size() - at >= 12) {
    const std::size_t length = BigEndian(bytes.substr(at));
    if (length > bytes.size() - at - 12) return "the file is cut off";
    const std::string_view type = bytes.substr(at + 4, 4);
    if (Crc(bytes.substr(at + 4, length + 4)) != BigEndian(bytes.substr(at + 8 + length))) {
      return "the checksum of a part is wrong";
    }
    at += length + 12;
    if (type == "IEND") return {};
  }
  return "the file is cut off";
}

std::string ImageFault(std::string_view bytes) {
  if (bytes.empty()) return "the file is empty";
  if (BeginsWith(bytes, kPngBegin)) return PngFault(bytes);
  if (!BeginsWith(bytes, kJpegBegin)) return "the file is no PNG or JPEG image";
  // JPEG has no checksums: only a cut is sure to be seen.
  const std::size_t end = bytes.rfind(kJpegEnd);
  return end == std::string_view::npos || end + kMostPadding < bytes.size() ? "the file is cut off" : "";
}

Expected<cv::Mat> Decode(std::string_view bytes, const std::string& name) {
  const std::string fault = ImageFault(bytes);
  if (!fault.empty()) return Fail(ErrorCode::kUnreadable, fault, name);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    cv::Mat image = cv::imdecode(raw, cv::IMREAD_UNCHANGED);
    if (!image.empty()) return image;
  } catch (const std::exception&) {
    // Told below.
  }
  return Fail(ErrorCode::kUnreadable, "the image is damaged", name);
}

tl::unexpected<Error> WrongPixels(const cv::Mat& image, const std::string& wanted, const std::string& name) {
  return Fail(
      ErrorCode::kMalformed,
      std::to_string(image.channels()) + " channels of " + std::to_string(8 * image.elemSize1()) + " bits, " + wanted,
      name);
}

}  // namespace

Expected<DepthImage> DecodeDepthImage(std::string_view bytes, const std::string& name) {
  const Expected<cv::Mat> image = Decode(bytes, name);
  if (!image) return Forward(image);
  if (image->type() != CV_16UC1) return WrongPixels(*image, "a depth image has one of 16", name);
  DepthImage depth{image->cols, image->rows, {}};
  depth.values.assign(image->begin<std::uint16_t>(), image->end<std::uint16_t>());
  return depth;
}

Expected<PixelMask> DecodeMask(std::string_view bytes, const std::string& name, int threshold) {
  const Expected<cv::Mat> image = Decode(bytes, name);
  if (!image) return Forward(image);
  if (image->type() != CV_8UC1) return WrongPixels(*image, "a mask has one of 8", name);
  PixelMask mask{image->cols, image->rows, {}};
  mask.inside.reserve(image->total());
  for (auto pixel = image->begin<std::uint8_t>(); pixel != image->end<std::uint8_t>(); ++pixel) {
    mask.inside.push_back(*pixel >= threshold ? 1 : 0);
  }
  return mask;
}

}  // namespace mocurate
