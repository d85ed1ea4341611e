#pragma once

#include <optional>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// What tracks say throughout a clip that no body allows; they are left as they are. Of joints that 20 frames show:
/// - "joints_exchanged" (error): a joint of a limb and the one below it have each other's columns: with the two
///   exchanged its upper bone has the other side's length (value: by how much it differs, metres), or, of both sides,
///   its two bones a person's proportion (value: the upper bone as named, metres).
/// - "joint_misplaced" (error): all bones at a joint differ from those of the other side, and more than these from the
///   skeleton's in the person's size; of a joint on the midline they are longer than these. Value: by how much at most,
///   metres.
/// - "body_grows" (warning): nearly all bones grow, or shrink, from the clip's begin to its end. Value: by how much, %.
/// - "size_doubtful" (warning): the body is larger or smaller than people are. Value: stature, metres.
std::vector<Finding> FindImplausibleBody(const SkeletonTracks& tracks);

/// "size_doubtful" (error) of a body that was measured from depth views, by the same rule: its `stature` from lowest to
/// highest joint, metres, and its size against the rest skeleton's. Unlike tracks, whose scale may be off and their
/// motion right, a body of such a size has been fitted to something else than one person. A warning of one that is a
/// child's, as somebody is measured whose legs are never seen.
std::optional<Finding> FindDoubtfulSize(double stature, double scale);

/// "joint_unexplained" (error): a joint of the fitted body lies, in the median of 10 frames or more that show it, more
/// than 0.2 m from where it is tracked, so that the fit gave it up for the others. Value: that median, metres. `joints`
/// (F, J) as `tracks`. Where samples have precisions the distance is weighted by them: far along rays that hardly cross
/// is not far off.
std::vector<Finding> FindUnexplainedJoints(const SkeletonTracks& tracks, const JointPositions& joints);

/// "joint_beyond_limits" (warning): a joint is turned, in the median of 10 frames or more that observe it, more than 20
/// degrees beyond the limits of its skeleton, though these hold it softly: points that lie beside the joints of their
/// names fold a trunk. Value: that median, degrees.
std::vector<Finding> FindJointsBeyondLimits(const Motion& motion);

}  // namespace mocurate
