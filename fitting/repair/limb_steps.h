#pragma once

namespace mocurate {

// Steps of limbs between two observations, for exchanged sides and coincident limbs.
inline constexpr double kLimbSpeed = 1.5;       ///< m/s per axis, of a limb relative to the body's centre
inline constexpr double kMostSampleCost = 8.0;  ///< cost (negative log likelihood) at most of one sample: an outlier
inline constexpr double kStepGap_s = 0.25;      ///< longest time between two observations that form a step

}  // namespace mocurate
