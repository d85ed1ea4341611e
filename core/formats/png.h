#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/geometry/depth_image.h"

namespace mocurate {

/// A depth image as PNG of one 16-bit channel (rows filtered by the one above, deflate). Same image, same bytes with
/// one version of zlib. Error kInconsistent: the count of values is not width times height, or that is 0.
Expected<std::string> EncodePng(const DepthImage& image);

/// Whether a PNG of any kind is whole: its chunks with their checksums up to the end mark, and pixels that unpack to as
/// many bytes as the header says. Error kMalformed with the chunk that is not, "depth.png:IDAT".
Status CheckPng(std::string_view bytes, const std::string& name);

/// Whether every sample of a whole PNG is 0. False for what is no whole PNG.
bool IsBlankPng(std::string_view bytes);

}  // namespace mocurate
