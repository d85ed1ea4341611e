#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/cloud_shape.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/options.h"

namespace mocurate {

/// Size, shape and bones of a person, from clouds of any frames and clips of theirs; the rest skeleton's without
/// points. A declared height is kept. Bodies of several sizes are posed in a few of the clouds, and the size at
/// which poses explain these best is looked for (a profile of the cost); then size and shape are fitted with those
/// poses (FitShape). Of a skeleton without a template shape the size alone, at which poses and radii explain the clouds
/// best. Errors of FindStart and FitCloudFrame.
Expected<ShapedPerson> PersonFromClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                        const PointCloudOptions& options);

}  // namespace mocurate
