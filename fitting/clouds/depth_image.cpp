#include "fitting/clouds/depth_image.h"

#include <open3d/geometry/Image.h>
#include <open3d/io/ImageIO.h>
#include <open3d/utility/Logging.h>

#include <exception>
#include <optional>
#include <string>

#include "core/base/file.h"
#include "core/formats/png.h"

namespace mocurate {
namespace {

/// Bytes of the pixels that a JPEG declares in the header of its frame; empty where it has none.
std::optional<std::uint64_t> DeclaredPixels(const std::string& jpeg) {
  const auto byte = [&jpeg](std::size_t at) -> std::uint64_t { return static_cast<unsigned char>(jpeg[at]); };
  for (std::size_t at = 2; at + 10 <= jpeg.size() && byte(at) == 0xFF;) {
    const std::uint64_t marker = byte(at + 1);
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) return (byte(at + 5) << 8 | byte(at + 6)) * (byte(at + 7) << 8 | byte(at + 8)) * byte(at + 9);
    at += marker == 0xFF ? 1 : 2 + (byte(at + 2) << 8 | byte(at + 3));  // a filling byte, or a segment
  }
  return std::nullopt;
}

Expected<PngImage> ReadJpeg(const std::string& bytes, const std::filesystem::path& path) {
  const auto pixels = DeclaredPixels(bytes);
  if (pixels && *pixels > MostUnpacked(bytes.size())) {
    return Fail(ErrorCode::kMalformed,
                "the image unpacks to " + std::to_string(*pixels) + " bytes; a file of " +
                    std::to_string(bytes.size()) + " bytes may hold " + std::to_string(MostUnpacked(bytes.size())),
                path.string(), "make the image smaller");
  }
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);  // standard output is for documents
  try {
    open3d::geometry::Image image;
    if (pixels && open3d::io::ReadImageFromJPG(path.string(), image) && image.HasData())
      return PngImage{{image.width_, image.height_, 8, image.num_of_channels_}, std::move(image.data_)};
  } catch (const std::exception&) {
    // Reported below.
  }
  return Fail(ErrorCode::kMalformed, "not a PNG or JPEG image, or damaged", path.string(), "copy it again");
}

}  // namespace

Expected<PixelMask> ReadPixelMask(const std::filesystem::path& path) {
  const Expected<std::string> bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  const bool is_png = bytes->compare(0, 4, "\x89PNG") == 0;
  const Expected<PngImage> image = is_png ? DecodePng(*bytes, path.string()) : ReadJpeg(*bytes, path);
  if (!image) return Forward(image);
  if (image->header.bits != 8) return Fail(ErrorCode::kMalformed, "a mask has channels of 8 bits", path.string());
  PixelMask mask{image->header.width, image->header.height, {}};
  const auto channels = static_cast<std::size_t>(image->header.channels);
  for (std::size_t i = 0; i < image->bytes.size(); i += channels) mask.inside.push_back(image->bytes[i] >= 128 ? 1 : 0);
  return mask;
}

Expected<DepthImage> ReadDepthImage(const std::filesystem::path& path) {
  const Expected<std::string> bytes = ReadFile(path);
  return bytes ? DecodeDepthPng(*bytes, path.string()) : Forward(bytes);
}

}  // namespace mocurate
