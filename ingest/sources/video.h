#pragma once

#include <filesystem>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// What the header of a video file says. `frames` is its own count: what can be decoded may be fewer.
struct VideoFacts {
  int frames = 0;  ///< 0: the file does not say
  double rate_hz = 0.0;
  int width = 0, height = 0;  ///< pixels
  std::string codec;          ///< four characters, "MJPG"; empty where there are none
};

/// By OpenCV. Errors kNotFound; kMalformed for a file that is not a video or has no rate or size.
Expected<VideoFacts> ReadVideoFacts(const std::filesystem::path& file);

}  // namespace mocurate
