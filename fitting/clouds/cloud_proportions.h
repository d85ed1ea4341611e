#pragma once

#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// Whether an error ends the whole step and not only one clip.
inline bool EndsAll(ErrorCode code) { return code == ErrorCode::kInterrupted || code == ErrorCode::kInternal; }

/// A person's body from the depth views of their clips.
struct BodyFromClouds {
  double scale = 1.0;               ///< relative to the rest skeleton
  SkeletonPtr skeleton;             ///< with the person's bone directions and shape
  std::vector<double> bone_length;  ///< (J) metres
  /// Unusable clips (their places in the list) and why: a damaged image, lengths in another unit, no views.
  std::vector<std::pair<std::size_t, Error>> nothing_from;
};

/// The body of one person from the depth views of their clips (PersonFromClouds), from a few fused clouds of each clip.
/// Without clips: the rest lengths. When no clip is usable: errors of WithAuditedRig and FuseClip, of the first clip
/// and with its id. Errors of PersonFromClouds; kInterrupted.
Expected<BodyFromClouds> MeasureBodyInClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                             const PointCloudOptions& options);

/// The same for clips with poses from other modalities. `motions` (clips): on `skeleton`'s joints at the times of the
/// depth views, of a person about `scale` times the rest skeleton. Only for a skeleton with a template shape
/// (HasTemplateShape).
Expected<BodyFromClouds> MeasurePosedBody(const std::vector<Clip>& clips, const std::vector<Motion>& motions,
                                          double scale, const SkeletonPtr& skeleton, const PointCloudOptions& options);

/// Applies bones and shape from clouds to a person of other modalities. The joints of `in_clouds` come first in
/// `skeleton`; further points of a tracker or detector keep their offsets. `bone_length` (J of `skeleton`): metres, all
/// set.
void UseBody(const BodyFromClouds& in_clouds, SkeletonPtr& skeleton, std::vector<double>& bone_length);

}  // namespace mocurate
