#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"

namespace mocurate {

/// The joints of a given motion as tracks of the joints of another skeleton; unknown names are excluded. Samples have
/// confidence 1, interpolated ones 0. Error kInconsistent when the two have no joint in common.
Expected<JointTracks> TracksOfMotion(const Motion& motion, const Skeleton& skeleton);

/// Evidence of a clip for the joints of `skeleton`: its tracks, else the joints of its given motion. Excluded names of
/// tracks go to `excluded`. Confidences are scaled so that the most confident tenth of the samples has 1. Errors of
/// MapTracks and TracksOfMotion, with the clip's id; kInconsistent for a clip that has neither.
Expected<SkeletonTracks> TracksOfClip(const Clip& clip, const SkeletonPtr& skeleton, OtherJoints other,
                                      std::vector<std::string>* excluded = nullptr);

}  // namespace mocurate
