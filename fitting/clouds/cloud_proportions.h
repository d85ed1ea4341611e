#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// Bone lengths of one person from the depth views of their clips (J, metres): the rest lengths times one scale
/// (ScaleFromClouds), of a few fused clouds of each clip. Single bones are not free: against a capsule body they take
/// up the error of its shape. No clips: the rest lengths. Errors of FuseClip and ScaleFromClouds.
Expected<std::vector<double>> BoneLengthsFromClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                                    const PointCloudOptions& options);

}  // namespace mocurate
