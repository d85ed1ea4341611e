#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "report/filmstrip.h"
#include "report/posed_body.h"

namespace mocurate {

/// What the pictures are made of; only for files that draw with OpenCV. Colours are blue, green, red.

/// A camera that looks at `centre` from the viewpoint, far away, `pixels_per_metre` at the centre.
Camera LookAt(const Viewpoint& view, const Vector3d& centre, double pixels_per_metre, int width, int height);

/// A body with soft light on it, and what was in the way: (height,width) metres along z, 0 for nothing.
struct ShadedBody {
  cv::Mat image;  ///< CV_8UC3
  std::vector<float> depth;
};
/// Left limbs blue, right ones orange, the trunk grey; over a shadow on the floor at `floor_y`.
ShadedBody ShadeBody(const PosedBody& body, const Camera& camera, double floor_y);

/// CV_16UC1; a frame that the view has no image of (an empty name) measured nothing. Error kMalformed, kNotFound,
/// kInconsistent (other size than the camera).
Expected<cv::Mat> ReadDepth(const DepthView& view, int frame);

Expected<std::string> EncodePng(const cv::Mat& image);
Status WritePng(const cv::Mat& image, const std::filesystem::path& png);

/// Error kInconsistent unless the clip has a motion and the frame.
Status CheckFrame(const Clip& fitted, int frame);

}  // namespace mocurate
