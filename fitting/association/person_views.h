#pragma once

#include <vector>

#include "fitting/association/associate.h"
#include "fitting/association/rig_view.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// One person's keypoints in every view at the times of the take, without lens distortion: those of the view's frame
/// at that time (to a thousandth of its step), else on the line between the two frames around it, where both see the
/// keypoint and lie at most 2.5 usual steps of the view apart.
std::vector<ViewKeypoints> ViewsOfPerson(const std::vector<RigView>& rig, const Association& take,
                                         const AssociatedPerson& person);

}  // namespace mocurate
