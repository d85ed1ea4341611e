#pragma once

#include <string>

#include "core/base/error.h"
#include "core/geometry/depth_image.h"

namespace mocurate {

/// A depth image as PNG of one 16-bit channel (rows filtered by the one above, deflate). Same image, same bytes with
/// one version of zlib. Error kInconsistent: the count of values is not width times height, or that is 0.
Expected<std::string> EncodePng(const DepthImage& image);

}  // namespace mocurate
