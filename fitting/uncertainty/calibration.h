#pragma once

namespace mocurate {

/// The figures of stated uncertainty that are calibrated on people with known motions, and nothing else is. Set and
/// checked on different seeds (docs/uncertainty.md).

/// Factor on the variance of joint tracks and keypoints, as the random walk allows for more than people do. Source:
/// bench_studio_fits 201, bench_keypoints 4711, bench_fit_clouds mix=1 8203; checked on 7001 to 7005
inline constexpr double kUncertaintyCalibration = 0.62;

/// m; standard deviation per axis of the end of a capsule whose body was measured, from that of the person. Its
/// radius: two thirds. Source: bench_fit_clouds 8201 to 8203; checked on 8301 and 8302
inline constexpr double kCapsuleSigma = 0.0015;

/// Share of the spread of bones between people (SpreadOfBone) that is left where joint tracks measured them, in fits of
/// tracks or keypoints with depth. Source: bench_fit_clouds mix=1 8202; checked on 8201 and 8203
inline constexpr double kMeasuredBones = 0.5;

}  // namespace mocurate
