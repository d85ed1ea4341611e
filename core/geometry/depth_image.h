#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"

namespace mocurate {

/// Raw depth values of a sensor, row-major, (height*width); 0 means nothing measured.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;
};

/// Mask of a person's pixels, row-major, (height*width): 0 or 1.
struct PixelMask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> inside;
};

/// Every measured pixel (inside the mask, if given), in the order of the pixels, as a point in the camera's frame,
/// metres: depth is along the optical axis, lens distortion is inverted. The camera's image size is not read; a mask of
/// another size than the image gives nothing.
std::vector<Vector3d> BackProject(const DepthImage& depth, const Camera& camera, double metres_per_unit,
                                  const PixelMask* mask = nullptr);

}  // namespace mocurate
