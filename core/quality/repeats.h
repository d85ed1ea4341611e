#pragma once

#include "core/quality/tracked_points.h"

namespace mocurate {

struct RepeatLimits {
  int frozen_frames = 2;  ///< consecutive frames without any motion
  int held_frames = 3;    ///< consecutive frames in which one joint repeats its value while others move
};

/// Positions that repeat to the last digit, which sensor noise excludes: a frame written twice, a stream that hung, or
/// joints filled with their last value.
///   "frozen_frames": every observed joint repeats; the span is the repeating frames, value their count. Two frames
///                    have severity info.
///   "repeated_frames": nearly all frames of the clip are repeated two to four times; value: the mean number of copies.
///                    Nothing else is then reported.
///   "repeated_value": one joint repeats and others do not; value the count of frames.
/// A hold with soft ends (steps below 1 mm, or that grow to more than twice) is intended: it occurs in authored and
/// simulated motion, and sensor noise prevents it. A clip in which at least half of the joints' holds are soft is
/// authored: none of its holds is reported, as its planted feet stop within a frame too. In a recorded clip all are.
/// Samples rounded to pixels or millimetres repeat by chance. There a hold is reported if it is longer than chance
/// explains, at the grid's step and the joint's speed around it, and does not begin and end with single grid steps. A
/// joint that never moves is ignored when other joints are checked for freezing. It is itself reported where most
/// joints and its parent move, but not if it is a root or fixed to a fixed joint. A clip without motion is one frozen
/// span.
std::vector<Finding> FindRepeats(const TrackedPoints& points, const RepeatLimits& limits = {});

/// Exact zeros marked as observed.
///   "zero_frames": runs of frames in which every joint is at 0 0 0; value the count of frames.
///   "zero_joint": one joint is at 0 0 0 in these frames while others are not; value the count of frames. The root
///                 may be there in all frames, or in the first: it is the clip's origin.
///   "collapsed_frames": all joints (three or more) lie within 2 cm, but elsewhere they make a body, or never do.
std::vector<Finding> FindBlanks(const TrackedPoints& points);

}  // namespace mocurate
