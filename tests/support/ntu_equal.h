#pragma once

#include <tuple>

#include "core/formats/ntu_skeleton.h"

namespace mocurate {

inline auto Tied(const NtuJoint& j) {
  return std::tie(j.x_m, j.y_m, j.z_m, j.depth_u, j.depth_v, j.colour_u, j.colour_v, j.qw, j.qx, j.qy, j.qz,
                  j.tracking);
}

inline auto Tied(const NtuBody& b) {
  return std::tie(b.id, b.clipped_edges, b.hand_left_confidence, b.hand_left_state, b.hand_right_confidence,
                  b.hand_right_state, b.is_restricted, b.lean_x, b.lean_y, b.tracking, b.joints);
}

inline bool operator==(const NtuJoint& a, const NtuJoint& b) { return Tied(a) == Tied(b); }
inline bool operator==(const NtuBody& a, const NtuBody& b) { return Tied(a) == Tied(b); }
/// Of the frames; what was found on the way does not count.
inline bool operator==(const NtuSkeleton& a, const NtuSkeleton& b) { return a.frames == b.frames; }

}  // namespace mocurate
