#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

/// Covariance (F*J*6; xx xy xz yy yz zz, m^2) of what the fit may be off by where a joint's samples depart from it to
/// one side for half a second, by more than their noise explains: the pose is then held elsewhere, by bones or priors
/// that do not fit, by a start from which it did not get away (two cameras that face each other see a shoulder in front
/// and one behind alike), or by a tracker that errs in the same way for long. The outer product of the mean departure,
/// less what noise adds to it. Departures are weighted by the robust information of the samples over `factor`, the
/// a-posteriori variance. `whole` is the whole clip at its solution.
std::vector<float> CovarianceOfLasting(const TrackWindow& whole, double factor);

}  // namespace mocurate
