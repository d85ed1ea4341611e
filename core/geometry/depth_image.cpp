#include "core/geometry/depth_image.h"

namespace mocurate {

std::vector<Vector3d> BackProject(const DepthImage& depth, const Camera& camera, double metres_per_unit,
                                  const PixelMask* mask) {
  std::vector<Vector3d> points;
  if (mask != nullptr && (mask->width != depth.width || mask->height != depth.height)) return points;
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const std::size_t pixel = static_cast<std::size_t>(v) * depth.width + u;
      if (depth.values[pixel] == 0 || (mask != nullptr && mask->inside[pixel] == 0)) continue;
      points.push_back(camera.Unproject(Vector2d(u, v), depth.values[pixel] * metres_per_unit));
    }
  }
  return points;
}

}  // namespace mocurate
