#include "fitting/clouds/depth_image.h"

#include <open3d/geometry/Image.h>
#include <open3d/io/ImageIO.h>
#include <open3d/utility/Logging.h>

#include <exception>
#include <string>

#include "core/base/file.h"
#include "core/formats/png.h"

namespace mocurate {
namespace {

Expected<PngImage> ReadJpeg(const std::filesystem::path& path) {
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);  // standard output is for documents
  try {
    open3d::geometry::Image image;
    if (open3d::io::ReadImageFromJPG(path.string(), image) && image.HasData())
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
  const Expected<PngImage> image = is_png ? DecodePng(*bytes, path.string()) : ReadJpeg(path);
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
