#pragma once

#include <cmath>

namespace mocurate {

inline double Square(double value) { return value * value; }

/// Excess of an angle over its limits: positive above `max`, negative below `min`, 0 inside.
inline double BeyondLimit(double angle, double min, double max) {
  return angle > max ? angle - max : angle < min ? angle - min : 0.0;
}

/// Huber's loss of a squared residual, as ceres::HuberLoss: quadratic up to `sigmas`, linear beyond. Value and slope.
inline double HuberValue(double square, double sigmas) {
  return square <= sigmas * sigmas ? square : 2.0 * sigmas * std::sqrt(square) - sigmas * sigmas;
}
inline double HuberSlope(double square, double sigmas) {
  return square <= sigmas * sigmas ? 1.0 : sigmas / std::sqrt(square);
}

}  // namespace mocurate
