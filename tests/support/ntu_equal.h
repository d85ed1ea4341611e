#pragma once

#include <tuple>

#include "core/formats/ntu_skeleton.h"

namespace mocurate {

inline auto Tied(const NtuJoint& j) {
  return std::tie(j.x_m, j.y_m, j.z_m, j.depth_u, j.depth_v, j.colour_u, j.colour_v, j.qw, j.qx, j.qy, j.qz,
                  j.tracking);
}

inline bool operator==(const NtuJoint& a, const NtuJoint& b) { return Tied(a) == Tied(b); }
inline bool operator==(const NtuBody& a, const NtuBody& b) { return a.id == b.id && a.joints == b.joints; }
/// Of the frames; what was found on the way does not count.
inline bool operator==(const NtuSkeleton& a, const NtuSkeleton& b) { return a.frames == b.frames; }

}  // namespace mocurate
