#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_start.h"

namespace mocurate {

/// A clip's clouds and the body that was tracked through them.
struct CloudTrack {
  std::vector<FusedCloud> clouds;           ///< (F)
  CapsuleBody body;                         ///< with the person's radii
  PoseState state;                          ///< all frames
  std::vector<CapsuleFitOutcome> outcomes;  ///< (F); iterations 0 where a frame has no points
  CloudStart start;                         ///< of the first frame with points
};

/// The person in all frames of a clip, or `frames` of them, evenly spread: of its depth views, else of its cloud files.
/// Errors of FuseViews and ReadPersonCloud; kInconsistent without either, with views of unequal length or of stamps
/// that do not increase.
Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options);
Expected<std::vector<FusedCloud>> FuseClip(const Clip& clip, const PointCloudOptions& options, int frames);
/// The frame that cloud `i` of `count` was fused from.
inline int FrameOfFew(int i, int count, int available) {
  return static_cast<int>(static_cast<long long>(i) * available / count);
}

/// Finds the first pose by trying several, measures the radii there, then follows frame after frame and looks for the
/// pose anew after 0.4 s without points; frames that are
/// explained worse than most are fitted once more from the frames after and before them, and where they are explained
/// three times worse the pose is looked for anew. Bones (J, metres)
/// are held; `time_s` (F) increases. Error kInconsistent when no frame has points.
Expected<CloudTrack> TrackClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                 const std::vector<double>& bone_length, const std::vector<double>& time_s,
                                 const PointCloudOptions& options);

}  // namespace mocurate
