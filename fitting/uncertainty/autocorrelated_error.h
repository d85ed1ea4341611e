#pragma once

#include "fitting/solver/track_window.h"

namespace mocurate {

/// Variance inflation of a mean of `averaged` samples of one joint against white noise: 1 + 2 sum (1 - k / n) rho_k
/// over the lags k below n. rho is the autocorrelation of observed bones' departures from the body's lengths, which no
/// pose explains. It is measured along bones and assumed across them. A common error of a whole body does not show in
/// bones. 1 where neighbouring frames are hardly correlated. `whole` is the clip at its solution.
double AutocorrelationInflation(const TrackWindow& whole, double averaged);

}  // namespace mocurate
