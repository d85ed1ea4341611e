#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/clouds/capsule_fit.h"

namespace mocurate {

/// A clip's clouds and the body that was tracked through them.
struct CloudTrack {
  std::vector<FusedCloud> clouds;           ///< (F)
  FleshBody body;                           ///< with the person's radii
  PoseState state;                          ///< all frames
  std::vector<CapsuleFitOutcome> outcomes;  ///< (F); iterations 0 where a frame has no points
};

/// Fuses all frames of a clip, or `frames` of them, evenly spread. Errors of FuseViews; kInconsistent without views or
/// with views of unequal length.
Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options);
Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options, int frames);

/// Size of the person against the rest skeleton: the median height of clouds against that of the rest body. 1 without
/// points.
double ScaleFromHeight(const SkeletonPtr& skeleton, const std::vector<FusedCloud>& clouds);

/// Finds the first pose by trying several, measures the radii there, then follows frame after frame. Bones (J, metres)
/// are held. Error kInconsistent when no frame has points.
Expected<CloudTrack> TrackClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                 const std::vector<double>& bone_length, double frame_seconds,
                                 const PointCloudOptions& options);

}  // namespace mocurate
