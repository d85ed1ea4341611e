#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// Bone lengths of one person from the depth views of their clips (J, metres): the size from the person's height, each
/// clip tracked with bones of that size, then a few of its frames fitted together with free bones; the mean over clips,
/// left and right the same. At most two clips are looked at. No clips: the rest lengths. Errors of FitClouds.
Expected<std::vector<double>> BoneLengthsFromClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                                    const PointCloudOptions& options);

}  // namespace mocurate
