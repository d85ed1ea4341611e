#pragma once

#include "core/quality/tracked_points.h"

namespace mocurate {

struct PositionJumpLimits {
  double speed = 12.0;   ///< m/s: no trunk moves faster (the fastest sprint is 12.4 m/s at its peak)
  double slack = 0.3;    ///< metres that a tracker may be off on top of it
  double start = 50.0;   ///< m/s2: no whole body accelerates faster
  double sudden = 0.15;  ///< metres that a tracker may be off on top of that
  int lost_frames = 0;   ///< between two frames, which nothing says: the person goes on at their pace in these
  double reach = 2.5;    ///< metres from the middle of the body: farther no joint of a person can be
};

/// A person who is suddenly elsewhere.
///   "position jump": the body, in frames that no possible path joins to the rest of the clip: at most at `speed`, and,
///   where
///               three quarters of the points go along, at the pace of the 8 frames on either side changed by `start`
///               at most. The rest is the longest chain of frames that such a path joins; value: metres from that path.
///               With `lost_frames` a step may besides be so many times that pace (the middle step): who runs goes on
///               through a gap, who stands does not. Between frames that see different joints those count that both
///               see.
///   "unrecovered_jump": the step from or to such frames at an end of the clip, where `speed` alone is kept: the body
///   does not
///                go back, and which side of the step is right nothing tells; value: metres.
///   "joint_far": one joint (the root alone, say), farther than `reach` from the middle of the body; value: metres.
std::vector<Finding> FindPositionJumps(const TrackedPoints& points, const PositionJumpLimits& limits = {});

}  // namespace mocurate
