#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/skeleton.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/options.h"

namespace mocurate {

/// A person's size and shape, and their poses in some clouds.
struct ShapedPerson {
  double scale = 1.0;                      ///< relative to the rest skeleton
  double scale_sigma = 0.15;               ///< prior standard deviation of the logarithm of the scale
  BodyShape shape{};                       ///< relative to the template of that size
  std::vector<std::vector<double>> poses;  ///< approximate PoseState::FrameParameters in each cloud
};

/// The skeleton with the bone directions and body shape of `shape`. Rest offsets keep the lengths of a person of the
/// skeleton's size. `skeleton`: a named one without a shape of its own. A skeleton without SMPL's joints is returned
/// unchanged.
SkeletonPtr WithShape(const SkeletonPtr& skeleton, const BodyShape& shape);

/// Fits size and shape together with the poses, from approximate size and poses. Poses are eliminated (a profile), so
/// that the body only explains what poses cannot. The shape has a prior from the usual variation between people. All
/// clouds together count as one, because capsule errors are the same in all. Errors of FitCloudFrame; kInterrupted.
Expected<ShapedPerson> FitShape(const std::vector<FusedCloud>& clouds, const SkeletonPtr& skeleton, ShapedPerson person,
                                const PointCloudOptions& options);

/// Size, shape and bones of a person, from clouds of any frames and clips of theirs; those of the rest skeleton without
/// points. A given height is fixed. The size is the one at which poses best explain a few of the clouds (a profile of
/// the cost). Then size and shape are fitted with those poses (FitShape). For a skeleton without a template shape, only
/// the size is fitted, with poses and radii. Errors of FindStart and FitCloudFrame.
Expected<ShapedPerson> PersonFromClouds(std::vector<FusedCloud> clouds, const SkeletonPtr& skeleton,
                                        const PointCloudOptions& options);

}  // namespace mocurate
