#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

inline constexpr double kShortestBone_m = 1e-3;  ///< shorter bones are between joints that coincide by definition

/// Adds the second-order effect of large rotations along a bone to covariances of positions (F*J*6; xx xy xz yy yz zz,
/// m^2). First order has no uncertainty along the bone. With direction variance s rad^2 over both axes across it, the
/// end of a bone of length r comes nearer by r (1 - cos): mean square r^2 s^2 / 2, and 4/3 r^2 for a uniform direction.
/// s follows from the difference of the end's and the start's covariance, so joints with other evidence get none;
/// descendants of an end follow it. Joints observed in their frame are unchanged.
void AddSecondOrderCovariance(const TrackWindow& whole, std::vector<float>& position_cov);

}  // namespace mocurate
