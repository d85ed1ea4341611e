#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Raw depth values of a sensor, row-major, (height*width); 0 means nothing measured.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;
};

/// Reads a PNG of one 16-bit channel. Errors: kNotFound, kUnreadable for what is no PNG, kMalformed for other pixels.
Expected<DepthImage> ReadDepthImage(const std::filesystem::path& path);

/// Writes a PNG of one 16-bit channel. Error kCannotWrite.
Status WriteDepthImage(const DepthImage& image, const std::filesystem::path& path);

}  // namespace mocurate
