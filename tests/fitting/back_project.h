#pragma once

#include <algorithm>

#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// Every measured pixel of one view in the world, in the order of the pixels. Errors of ReadFrame.
inline Expected<Eigen::Matrix3Xd> BackProject(const DepthView& view, int frame) {
  const Expected<std::vector<DepthImage>> images = ReadFrame({view}, frame);
  if (!images) return Forward(images);
  const DepthImage& image = images->front();
  const auto is_measured = [](std::uint16_t value) { return value != 0; };
  Eigen::Matrix3Xd points(3, std::count_if(image.values.begin(), image.values.end(), is_measured));
  const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
  Eigen::Index next = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint16_t value = image.values[static_cast<std::size_t>(y) * image.width + x];
      if (!is_measured(value)) continue;
      points.col(next++) = world_from_camera * view.camera.Unproject(Vector2d(x, y), value * view.metres_per_unit);
    }
  }
  return points;
}

}  // namespace mocurate
