#pragma once

#include <array>
#include <vector>

#include "core/geometry/camera.h"

namespace mocurate {

/// Depth of a triangle mesh by a z-buffer: metres along the camera's z axis, 0 where nothing is hit; row-major,
/// (height*width). `vertices` in the world; `rays` of PixelRays. A pixel is covered when its centre lies in the
/// triangle's image; depth is that of the triangle's plane on the pixel's ray, exact also with lens distortion. Both
/// sides of a triangle are drawn; triangles with a corner nearer than `near` metres are not.
std::vector<float> RenderMesh(const std::vector<Vector3d>& vertices, const std::vector<std::array<int, 3>>& faces,
                              const Camera& camera, const std::vector<Vector2d>& rays, double near = 0.05);

}  // namespace mocurate
