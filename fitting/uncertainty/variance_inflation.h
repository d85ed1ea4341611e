#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/solver/track_problem.h"

namespace mocurate {

/// Factors on the variances of long unobserved samples, 1 elsewhere: of positions and of rotations, (F*J).
struct GapInflation {
  std::vector<double> position;
  std::vector<double> rotation;
};

/// A long gap contains one movement (a step, a rotation), not many independent ones: errors grow with its length, a
/// random walk's with the root of it. Applies from gaps of 0.6 s, at most a factor of four on sigma, to a joint
/// unobserved there. A rotation has the factor of the joints below that determine it; a joint that is never observed,
/// that of the joints above and below. Calibrated on synthetic takes (`bench_studio_fits` with gap=SECONDS).
GapInflation FindGapInflation(const SkeletonTracks& tracks);

/// Variance inflation of a mean of `averaged` samples of one joint against white noise: 1 + 2 sum (1 - k / n) rho_k
/// over the lags k below n. rho is the autocorrelation of observed bones' departures from the body's lengths, which no
/// pose explains. It is measured along bones and assumed across them. A common error of a whole body does not show in
/// bones. 1 where neighbouring frames are hardly correlated. `whole` is the clip at its solution.
double AutocorrelationInflation(const TrackProblem& whole, double averaged);

/// Covariance (F*J*6; xx xy xz yy yz zz, m^2) where a joint's samples depart from the fit to one side for half a
/// second, beyond their noise. Causes are bones or priors that do not fit, a local minimum (two cameras that face each
/// other see a shoulder in front and one behind alike), or a persistent error of the tracker. It is the outer product
/// of the mean departure, minus the part of noise. Departures are weighted by the robust information of the samples
/// over `factor`, the a-posteriori variance. `whole` is the whole clip at its solution.
std::vector<float> PersistentResidualCovariance(const TrackProblem& whole, double factor);

}  // namespace mocurate
