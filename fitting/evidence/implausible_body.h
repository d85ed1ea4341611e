#pragma once

#include <optional>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Faults that tracks show throughout a clip; the tracks are not changed. Of joints that 20 frames show:
/// - "joints_exchanged" (error): the columns of a limb's joint and of the one below it are exchanged. Value, metres:
/// difference of the upper bone from the other side's; on both sides, the upper bone as named.
/// - "joint_misplaced" (error): all bones at a joint differ from the other side's, and more than these from the
/// skeleton's in the person's size. On the midline: they are too long. Value: largest difference, metres.
/// - "body_grows" (warning): nearly all bones grow, or shrink, from the clip's begin to its end. Value: change, %.
/// - "size_suspect" (warning): the body is larger or smaller than any person. Value: stature, metres.
std::vector<Finding> FindImplausibleBody(const SkeletonTracks& tracks);

/// "size_suspect" (error) of a body measured from depth views, by the same rule. `stature`: lowest to highest joint,
/// metres; `scale`: size over the rest skeleton's. It is an error because such a body was fitted to something else than
/// one person. A warning for a child's size, which a person whose legs are never seen also gets.
std::optional<Finding> CheckStature(double stature, double scale);

/// "joint_unexplained" (error): a joint of the fitted body lies more than 0.2 m from its tracked position, in the
/// median of 10 frames or more that show it. Value: that median, metres. `joints` (F, J) as `tracks`. Precisions of
/// samples weight the distance, as rays that hardly cross leave it open along them.
std::vector<Finding> FindUnexplainedJoints(const SkeletonTracks& tracks, const JointPositions& joints);

/// "joint_beyond_limits" (warning): a joint is rotated more than 20 degrees beyond the skeleton's soft limits, in the
/// median of 10 frames or more that observe it. Points beside the joints of their names cause this. Value: that median,
/// degrees.
std::vector<Finding> FindJointsBeyondLimits(const Motion& motion);

}  // namespace mocurate
