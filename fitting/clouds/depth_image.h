#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "core/geometry/depth_image.h"

namespace mocurate {

/// Reads a PNG of one 16-bit channel. Errors: kNotFound, kUnreadable for what is no PNG, kMalformed for other pixels.
Expected<DepthImage> ReadDepthImage(const std::filesystem::path& path);

/// Writes a PNG of one 16-bit channel. Error kCannotWrite.
Status WriteDepthImage(const DepthImage& image, const std::filesystem::path& path);

}  // namespace mocurate
