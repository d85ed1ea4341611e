#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

/// Adds to covariances of positions (F*J*6; xx xy xz yy yz zz, m^2) what turns that are not small do along a bone. A
/// covariance to first order is sure of the direction of the bone, for its end moves across it; an end whose bone of
/// length r has an uncertain direction, variance s rad^2 over both axes across it, also comes nearer by r (1 - cos):
/// mean square r^2 s^2 / 2, and 4/3 r^2 where every direction is as likely. The direction's is read from how much less
/// sure the end is than the start, so joints that other evidence holds get none; what hangs on an end follows it.
/// Joints that are seen in their frame are left alone.
void AddFarTurns(const TrackWindow& whole, std::vector<float>& position_cov);

}  // namespace mocurate
