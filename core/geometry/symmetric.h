#pragma once

#include <Eigen/Core>

namespace mocurate {

/// Symmetric 3 x 3 matrices stored as six numbers, xx xy xz yy yz zz: covariances of positions.
inline Eigen::Matrix3d FromSixNumbers(const float* c) {
  Eigen::Matrix3d full;
  full << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return full;
}

inline void ToSixNumbers(const Eigen::Matrix3d& full, float* c) {
  const double values[6] = {full(0, 0), full(0, 1), full(0, 2), full(1, 1), full(1, 2), full(2, 2)};
  for (int i = 0; i < 6; ++i) c[i] = static_cast<float>(values[i]);
}

}  // namespace mocurate
