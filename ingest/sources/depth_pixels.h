#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/geometry/depth_image.h"

namespace mocurate {

/// A PNG of one 16-bit channel. Error kUnreadable for what is no whole image, kMalformed for other pixels.
Expected<DepthImage> DecodeDepthImage(std::string_view bytes, const std::string& name);

/// A mask as PNG or JPEG of one 8-bit channel: inside from `threshold` up. JPEG smears the edge, so half way (128) is
/// it.
Expected<PixelMask> DecodeMask(std::string_view bytes, const std::string& name, int threshold = 128);

}  // namespace mocurate
