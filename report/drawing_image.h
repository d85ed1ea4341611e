#pragma once

#include <opencv2/core.hpp>

#include "report/drawing.h"

namespace mocurate {

/// The drawing on white, 8-bit blue, green, red, `scale` pixels a unit. Only for files that draw with OpenCV.
cv::Mat ToImage(const Drawing& drawing, double scale);

}  // namespace mocurate
