#pragma once

#include "core/body/capsule_body.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {

/// Ends of a capsule in a frame of a state. Needs Update.
inline CapsuleEnds EndsOf(const BodyCapsule& capsule, const PoseState& state, int frame) {
  return EndsOf(capsule, state.global(frame, capsule.frame), state.position(frame, capsule.frame),
                state.position(frame, capsule.end_joint));
}

/// A point and its matched capsule.
struct CloudMatch {
  int point = 0;
  int capsule = 0;
  double distance = 0.0;  ///< m, signed
};

}  // namespace mocurate
