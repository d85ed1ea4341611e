#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "core/base/error.h"
#include "report/filmstrip.h"

namespace mocurate {

/// Draws pictures 0 to `count` - 1 of one size with even sides and writes them atomically as H.264 (MP4). Returns their
/// number. Errors of drawing; kMissingOnHost where OpenCV finds no encoder, kCannotWrite; both name `item`.
Expected<int> WriteVideo(const std::string& item, double rate_hz, int count,
                         const std::function<Expected<cv::Mat>(int)>& draw, const std::filesystem::path& file);

/// The fitted body from its front with the tracked points before it, and over the images of its views, side by side, as
/// H.264 in MP4, at the speed of the clip, at most 60 a second and `most_pictures` in all. Errors kMissingOnHost where
/// OpenCV finds no encoder, kInconsistent for a clip without a motion, errors of depth images, kCannotWrite. Returns
/// the number of pictures.
Expected<int> WriteClipVideo(const DrawnClip& clip, const std::filesystem::path& file, int most_pictures = 450);

}  // namespace mocurate
