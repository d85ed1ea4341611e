#pragma once

#include "core/quality/tracked_points.h"

namespace mocurate {

struct PositionJumpLimits {
  double speed = 12.0;   ///< m/s: largest speed of a person's trunk (the fastest sprint peaks at 12.4 m/s)
  double slack = 0.3;    ///< metres that a tracker may be off on top of it
  double start = 50.0;   ///< m/s2: largest acceleration of a whole body
  double sudden = 0.15;  ///< metres that a tracker may be off on top of that
  int lost_frames = 0;   ///< undeclared, between two frames: the person continues at their speed in these
  double reach = 2.5;    ///< metres from the middle of the body: farther no joint of a person can be
};

/// Implausible changes of position.
///   "position_jump": frames of the body that no possible path joins to the rest of the clip. A path moves at most at
///   `speed`. Where three quarters of the points move along, its velocity differs from that of the 8 frames on either
///   side by at most `start`. The rest is the longest chain of frames on one path; value: metres from that path. With
///   `lost_frames` a step may also be that many times the median step: a runner continues through a gap. Between frames
///   with different observed joints the common ones count.
///   "unrecovered_jump": the step from or to these frames at an end of the clip, where only `speed` is required. The
///   body does not return, and the right side of the step is ambiguous; value: metres.
///   "joint_far": one joint (for example the root), farther than `reach` from the middle of the body; value: metres.
std::vector<Finding> FindPositionJumps(const TrackedPoints& points, const PositionJumpLimits& limits = {});

}  // namespace mocurate
