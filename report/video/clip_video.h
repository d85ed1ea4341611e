#pragma once

#include <filesystem>

#include "core/base/error.h"
#include "report/filmstrip.h"

namespace mocurate {

/// The fitted body from its front with the tracked points before it, and over the images of its views, side by side, as
/// H.264 in MP4, at the speed of the clip, at most 60 a second and `most_pictures` in all. Errors kMissingOnHost where
/// OpenCV finds no encoder, kInconsistent for a clip without a motion, errors of depth images, kCannotWrite. Returns
/// the number of pictures.
Expected<int> WriteClipVideo(const DrawnClip& clip, const std::filesystem::path& file, int most_pictures = 450);

}  // namespace mocurate
