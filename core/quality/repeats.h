#pragma once

#include "core/quality/tracked_points.h"

namespace mocurate {

struct RepeatLimits {
  int frozen_frames = 2;  ///< consecutive frames without any motion
  int held_frames = 3;    ///< frames on end in which one joint stands exactly still while others move
};

/// Places that repeat to the last digit, which no sensor gives of a living person: a frame written twice or a stream
/// that hung, and joints that another program filled with their last value.
///   "frozen_frames": every joint that is seen repeats; the span is the repeating frames, value their count. Two
///                    frames are of severity info.
///   "repeated_frames": nearly all frames stand two to four times, the clip over; value: how often in the mean. Then
///                    nothing else is reported.
///   "repeated_value": one joint repeats and others do not; value the count of frames.
/// Stillness that is entered and left softly (by steps below 1 mm, or that grow to more than twice) is meant: authored
/// and simulated motion stands so, and a sensor's noise does not let it. A clip in which at least half of the joints'
/// holds are soft is synthetic: its planted feet stop within a frame as well, and none of its holds is reported; of
/// a clip that was sensed all are. Samples that were rounded to pixels or millimetres repeat by chance: there a hold is
/// reported where it is longer than chance explains, at the grid's step and the joint's speed around it, and does not
/// begin and end with single steps of the grid. A joint that never moves in the whole clip tells nothing about whether
/// the others freeze; it is held where most joints move and the one it hangs on does, and is none where it is a root
/// (of many a BVH file) or bound to one that stays. A clip that never moves is one frozen span.
std::vector<Finding> FindRepeats(const TrackedPoints& points, const RepeatLimits& limits = {});

/// Exact zeros that stand as if they were seen.
///   "zero_frames": runs of frames in which every joint is at 0 0 0; value the count of frames.
///   "zero_joint": one joint is at 0 0 0 in these frames while others are not; value the count of frames. The root
///                 may be there in all frames, or in the first: it is the clip's origin.
///   "collapsed_frames": all joints (three or more) lie within 2 cm, but elsewhere they make a body, or never do.
std::vector<Finding> FindBlanks(const TrackedPoints& points);

}  // namespace mocurate
