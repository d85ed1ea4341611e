#pragma once

#include <vector>

#include "fitting/association/associate.h"
#include "fitting/association/rig_view.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// Median of the steps of a view's clock, seconds; 0 with fewer than two frames.
double UsualStep(const std::vector<double>& time_s);

/// Reads the keypoints (K each) of the entries (F of the view; -1: none) at a moment. Uses the view's frame at that
/// time (within a thousandth of `step`). Otherwise interpolates between the two frames around it, where both observe
/// the keypoint and are at most 2.5 steps apart. Writes nothing for unobserved keypoints.
void ReadBetweenFrames(const RigView& view, const std::vector<int>& entry, double step, double moment,
                       Vector2d* normalised, double* confidence);

/// One person's keypoints in every view at the times of the take, without lens distortion (ReadBetweenFrames).
std::vector<ViewKeypoints> ViewsOfPerson(const std::vector<RigView>& rig, const Association& take,
                                         const AssociatedPerson& person);

}  // namespace mocurate
