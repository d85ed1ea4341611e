#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/cloud_shape.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/options.h"

namespace mocurate {

/// Size, shape and bones of a person, from clouds of any frames and clips of theirs; those of the rest skeleton without
/// points. A given height is fixed. The size is the one at which poses best explain a few of the clouds (a profile of
/// the cost). Then size and shape are fitted with those poses (FitShape). For a skeleton without a template shape, only
/// the size is fitted, with poses and radii. Errors of FindStart and FitCloudFrame.
Expected<ShapedPerson> PersonFromClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                        const PointCloudOptions& options);

}  // namespace mocurate
