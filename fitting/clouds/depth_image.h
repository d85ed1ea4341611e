#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "core/geometry/camera.h"

namespace mocurate {

/// Reads a PNG of one 16-bit channel. Errors: kNotFound, kUnreadable, kMalformed for a damaged image or other pixels.
Expected<DepthImage> ReadDepthImage(const std::filesystem::path& path);

/// Reads a mask, an 8-bit PNG or JPEG: inside where the first channel is at least 128 (JPEG blurs edges). Errors of
/// ReadDepthImage.
Expected<PixelMask> ReadPixelMask(const std::filesystem::path& path);

}  // namespace mocurate
