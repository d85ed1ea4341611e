#pragma once

#include "fitting/solver/track_window.h"

namespace mocurate {

/// How many times the variance of a mean of `averaged` samples of one joint is that of white noise: the tracker's error
/// lasts from frame to frame, and averaging takes less of it away. 1 + 2 sum (1 - k / n) rho_k over the lags k below n,
/// rho the autocorrelation of observed bones' departures from the body's lengths, which no pose explains: it tells what
/// lasts along bones, and stands for what lasts across them. What moves a whole body alike shows in no bone. 1 where
/// departures of neighbouring frames are hardly alike, as those of white noise. `whole` is the clip at its solution.
double GrowthByLastingNoise(const TrackWindow& whole, double averaged);

}  // namespace mocurate
