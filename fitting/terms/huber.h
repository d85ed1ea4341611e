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

/// The length of a white residual of one or three coordinates that this share of clean samples exceeds.
inline double HuberSigmas(double share, int coordinates) {
  double least = 0.0, most = 40.0;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.5 * (least + most);
    double beyond = std::erfc(r * M_SQRT1_2);
    if (coordinates == 3) beyond += M_SQRT1_2 * M_2_SQRTPI * r * std::exp(-0.5 * r * r);
    (beyond > share ? least : most) = r;
  }
  return most;
}

}  // namespace mocurate
