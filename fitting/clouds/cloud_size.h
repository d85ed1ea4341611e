#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/options.h"

namespace mocurate {

/// Size of a person against the rest skeleton, from clouds of any frames and clips of theirs; 1 without points. A
/// height that is told is believed. Bodies of several sizes are posed in a few of the clouds, and the size at which
/// poses and radii explain these best is looked for (over all poses: a profile of the cost). Flesh that is not the
/// template's makes that size a few per cent wrong, which a height does not mind: where legs of those poses are
/// straight, the heights of the clouds against those of the posed body tell the size. Errors of FindStart and
/// FitCloudFrame.
Expected<double> ScaleFromClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                 const PointCloudOptions& options);

}  // namespace mocurate
