#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_start.h"

namespace mocurate {

/// A clip's clouds and the body tracked through them.
struct CloudTrack {
  std::vector<FusedCloud> clouds;           ///< (F)
  CapsuleBody body;                         ///< with estimated radii
  PoseState state;                          ///< all frames
  std::vector<CapsuleFitOutcome> outcomes;  ///< (F); iterations 0 for a frame without points
  CloudStart start;                         ///< of the first frame with points
};

/// Frames that are not `fitted` (F) get the pose of the previous fitted one, or of the next.
void FillFrames(const std::vector<bool>& fitted, PoseState& state);
void FillFrames(CloudTrack& track);

/// The person in all frames of a clip, or in `frames` evenly spaced ones, from its depth views or else its cloud files.
/// Errors of FuseViews and ReadPersonCloud; kInconsistent without either, for views of unequal length, and for stamps
/// that do not increase.
Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options);
Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options, int frames);
/// Frame index of cloud `i` of `count`.
inline int FrameOfFew(int i, int count, int available) {
  return static_cast<int>(static_cast<long long>(i) * available / count);
}

/// Searches the first pose from several starts, estimates the radii there, then tracks frame after frame; after 0.4 s
/// without points it searches again. Frames with a high cost are fitted again from their neighbours, and at three times
/// the median cost the pose is searched anew. Bones (J, metres) are fixed; `time_s` (F) increases. `first_pose`
/// (PoseState::FrameParameters): of the first frame with points, instead of a search. Error kInconsistent when no frame
/// has points.
Expected<CloudTrack> TrackClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                 const std::vector<double>& bone_length, const std::vector<double>& time_s,
                                 const PointCloudOptions& options, const std::vector<double>* first_pose = nullptr);

}  // namespace mocurate
