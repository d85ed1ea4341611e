#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/motion.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"

namespace mocurate {

/// A person's bones and the places of markers on them, learnt from trials.
struct MarkerBody {
  SkeletonPtr skeleton;             ///< that of the tracks, with the markers where this person wears them
  std::vector<double> bone_length;  ///< (J) metres, markers included: the distance from their joint
  std::vector<double> place_sigma;  ///< (J) metres per axis: of a marker's place, given the trials; 0 for joints
  double scale = 1.0;               ///< of the person against the rest skeleton
  int frames = 0;                   ///< that were used
};

/// Poses by FitJointTracks, then bone lengths, marker places and the person's scale by linear least squares over all
/// frames, in turn (as MoSh: Loper et al., SIGGRAPH Asia 2014). A marker lies at t + sum over the bones from the root
/// of G_parent d l, + G_joint o, with the frame's root t free. Priors: places by their spread, lengths by 6 %, sides by
/// 5 mm, scale by 10 %. `clips` are tracks on a skeleton whose markers are joints marked `landmark`, with
/// `place_sigma`. Errors of FitJointTracks.
Expected<MarkerBody> LearnMarkerBody(const std::vector<SkeletonTracks>& clips, const JointTrackOptions& options);

}  // namespace mocurate
