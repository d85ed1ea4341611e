#pragma once

#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// Errors that say nothing about a clip.
inline bool EndsAll(ErrorCode code) { return code == ErrorCode::kInterrupted || code == ErrorCode::kInternal; }

/// A person's body as the depth views of their clips tell it.
struct BodyFromClouds {
  double scale = 1.0;               ///< against the rest skeleton
  SkeletonPtr skeleton;             ///< with the person's own bone directions and shape
  std::vector<double> bone_length;  ///< (J) metres
  /// Clips that said nothing (their places in the list) and why: a damaged image, lengths in another unit, no views.
  std::vector<std::pair<std::size_t, Error>> nothing_from;
};

/// The body of one person from the depth views of their clips (PersonFromClouds), of a few fused clouds of each clip.
/// No clips: the rest lengths. Errors of WithAuditedRig and FuseClip, of the first clip and with its id, where no clip
/// says anything; of PersonFromClouds; kInterrupted.
Expected<BodyFromClouds> MeasureBodyInClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                             const PointCloudOptions& options);

/// The same of clips whose poses come from other evidence: `motions` (clips) on `skeleton`'s joints at the times of the
/// depth views, of a person about `scale` times as large as it. Only of a skeleton with a template shape
/// (HasTemplateShape).
Expected<BodyFromClouds> MeasurePosedBody(const std::vector<Clip>& clips, const std::vector<Motion>& motions,
                                          double scale, const SkeletonPtr& skeleton, const PointCloudOptions& options);

/// Gives a person of other evidence the bones and shape measured in clouds. The joints of `in_clouds` come first
/// in `skeleton`; points that a tracker or detector has beside them stay where they were. `bone_length` (J of
/// `skeleton`) metres, all given.
void UseBody(const BodyFromClouds& in_clouds, SkeletonPtr& skeleton, std::vector<double>& bone_length);

}  // namespace mocurate
