#pragma once

#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// A person's body as the depth views of their clips tell it.
struct BodyFromClouds {
  double scale = 1.0;               ///< against the rest skeleton
  std::vector<double> bone_length;  ///< (J) metres
  /// Clips that said nothing (their places in the list) and why: a damaged image, lengths in another unit, no views.
  std::vector<std::pair<std::size_t, Error>> nothing_from;
};

/// Bone lengths of one person from the depth views of their clips: the rest lengths times one scale
/// (ScaleFromClouds), of a few fused clouds of each clip. Single bones are not free: against a capsule body they take
/// up the error of its shape. No clips: the rest lengths. Errors of WithAuditedRig and FuseClip, of the first clip and
/// with its id, where no clip says anything; of ScaleFromClouds; kInterrupted.
Expected<BodyFromClouds> MeasureBodyInClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                             const PointCloudOptions& options);

}  // namespace mocurate
