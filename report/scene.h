#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "report/filmstrip.h"
#include "report/posed_body.h"

namespace mocurate {

/// Building blocks of the pictures; only for files that draw with OpenCV. Colours are blue, green, red.

/// A distant camera that looks at `centre` from the viewpoint, `pixels_per_metre` at the centre.
Camera LookAt(const Viewpoint& view, const Vector3d& centre, double pixels_per_metre, int width, int height);

/// A rendered body with soft light: its image, and its depth (height,width) in metres along z, 0 for nothing.
struct ShadedBody {
  cv::Mat image;  ///< CV_8UC3
  std::vector<float> depth;
};
/// Left limbs blue, right ones orange, the trunk grey; over a shadow on the floor at `floor_y`.
ShadedBody ShadeBody(const PosedBody& body, const Camera& camera, double floor_y);

/// CV_16UC1; a frame without an image (an empty name) is all 0. Error kMalformed, kNotFound, kInconsistent (other size
/// than the camera).
Expected<cv::Mat> ReadDepth(const DepthView& view, int frame);

Expected<std::string> EncodePng(const cv::Mat& image);
Status WritePng(const cv::Mat& image, const std::filesystem::path& png);

/// Error kInconsistent for a missing motion or frame.
Status CheckFrame(const Clip& fitted, int frame);

}  // namespace mocurate
