#pragma once

#include "core/body/bone_capsules.h"

namespace mocurate {

/// Depth of a body in a camera's picture, metres, row-major.
inline std::vector<float> RenderDepth(const BoneCapsules& body, const Vector3d* joints, const Camera& camera) {
  return RenderBody(body, joints, camera, PixelRays(camera)).depth;
}

}  // namespace mocurate
