#pragma once

#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Names of a 2-D detector's keypoints as a skeleton means them: where a detector lists the face, its "neck" is the
/// middle between the shoulders ("mid_shoulder"; BODY_25, COCO_18), not a joint of the spine.
std::vector<std::string> DetectorNames(const std::vector<std::string>& names);

/// The skeleton with an additional joint at the end, marked `landmark`, for each of `names` (as of DetectorNames) that
/// is a point fixed to a joint: the skeleton's own landmarks, else nose, eyes, ears, head_top, upper_neck,
/// mid_shoulder, toes and heels at their places on a body of the skeleton's size (measured on the CC0 body template).
/// Other names are skipped, and the middle of the hips where the root is another point.
SkeletonPtr WithDetectorPoints(const SkeletonPtr& skeleton, const std::vector<std::string>& names);

/// `skeleton` with the rest offsets of `body`, which also has the joints of WithDetectorPoints.
SkeletonPtr WithoutDetectorPoints(const SkeletonPtr& body, const SkeletonPtr& skeleton);

/// The tracks, or the motion, on that skeleton, without the joints that WithDetectorPoints appended to `skeleton`.
SkeletonTracks WithoutDetectorPoints(const SkeletonTracks& tracks, const SkeletonPtr& skeleton);
Motion WithoutDetectorPoints(const Motion& motion, const SkeletonPtr& skeleton);

}  // namespace mocurate
