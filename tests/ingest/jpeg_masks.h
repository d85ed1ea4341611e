#pragma once

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/geometry/camera.h"

namespace mocurate::test {

/// A JPEG mask whose lower half is inside. Empty when the input is no image.
inline PixelMask JpegMask(std::string bytes) {
  const cv::Mat image =
      cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, bytes.data()), cv::IMREAD_GRAYSCALE);
  PixelMask mask{image.cols, image.rows, {}};
  for (auto pixel = image.begin<std::uint8_t>(); pixel != image.end<std::uint8_t>(); ++pixel)
    mask.inside.push_back(*pixel >= 128 ? 1 : 0);
  return mask;
}

}  // namespace mocurate::test
