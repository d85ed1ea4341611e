#pragma once

#include <cmath>

namespace mocurate {

/// Huber's loss of a squared residual, as ceres::HuberLoss: quadratic up to `sigmas`, linear beyond. Value and slope.
inline double HuberValue(double square, double sigmas) {
  return square <= sigmas * sigmas ? square : 2.0 * sigmas * std::sqrt(square) - sigmas * sigmas;
}
inline double HuberSlope(double square, double sigmas) {
  return square <= sigmas * sigmas ? 1.0 : sigmas / std::sqrt(square);
}

}  // namespace mocurate
