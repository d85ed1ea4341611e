#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/skeleton.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/options.h"

namespace mocurate {

/// A person's size and shape, and their poses in some clouds.
struct ShapedPerson {
  double scale = 1.0;                      ///< against the rest skeleton
  double scale_spread = 0.15;              ///< deviation of the logarithm of the scale: how well it was known before
  BodyShape shape{};                       ///< against the template of that size
  std::vector<std::vector<double>> poses;  ///< PoseState::FrameParameters in each cloud, about
};

/// The skeleton with bone directions and capsules of that shape; lengths of rest offsets are those of a person
/// of the skeleton's size. `skeleton`: a named one, without a shape of its own. Another skeleton than one with SMPL's
/// joints stays as it is.
SkeletonPtr WithShape(const SkeletonPtr& skeleton, const BodyShape& shape);

/// From a size and poses that explain the clouds about: size and shape are fitted together with the poses, which are
/// eliminated (a profile: what another pose explains as well tells nothing of the body). The shape is held to people's
/// usual ones. However many clouds, they count as one: what capsules are off is the same in all of them. Errors of
/// FitCloudFrame; kInterrupted.
Expected<ShapedPerson> FitShape(const std::vector<FusedCloud>& clouds, const SkeletonPtr& skeleton, ShapedPerson person,
                                const PointCloudOptions& options);

}  // namespace mocurate
