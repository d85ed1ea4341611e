#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"

namespace mocurate {

/// The joints of a given motion as tracks of the joints of another skeleton: names that it does not know are left out.
/// Every sample has confidence 1, but 0 where the motion was interpolated. Error kInconsistent when the two have no
/// joint in common.
Expected<JointTracks> TracksOfMotion(const Motion& motion, const Skeleton& skeleton);

/// What a clip says of the joints of `skeleton`: its tracks, else the joints of its given motion. Names of tracks that
/// are left out go to `left_out`. Confidences are counted against that of the surest tenth of the samples, which has 1.
/// Errors of MapTracks and TracksOfMotion, with the clip's id; kInconsistent for a clip that has neither.
Expected<SkeletonTracks> TracksOfClip(const Clip& clip, const SkeletonPtr& skeleton, OtherJoints other,
                                      std::vector<std::string>* left_out = nullptr);

}  // namespace mocurate
