#pragma once

#include <vector>

#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"

namespace mocurate {

/// Each view's frames nearest to at most 24 moments, evenly spaced over the first view's. Empty when a view has no
/// frames.
std::vector<KeypointView> AtSomeMoments(const std::vector<KeypointView>& views, int keypoints);

/// Mean cost of all entries of a frame, each 0 (on the rays of a body that other views propose) to 1 (of no body). Adds
/// to `share` the share of entries that match a body.
double CostOfAgreement(const std::vector<RigView>& rig, int frame, const std::vector<KnownLength>& lengths,
                       double& share);

}  // namespace mocurate
