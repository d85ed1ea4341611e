#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Draws pictures 0 to `count` - 1 of one size with even sides and writes them atomically as H.264 (MP4). Returns their
/// number. Errors of drawing; kMissingOnHost where OpenCV finds no encoder, kCannotWrite; both name `item`.
Expected<int> WriteVideo(const std::string& item, double rate_hz, int count,
                         const std::function<Expected<cv::Mat>(int)>& draw, const std::filesystem::path& file);

}  // namespace mocurate
