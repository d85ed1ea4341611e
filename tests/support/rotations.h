#pragma once

#include <algorithm>

#include "core/geometry/rotation.h"

// Inverses of conversions of core/geometry, as references.

namespace mocurate {

/// Gram-Schmidt on the two vectors; norms are bounded below by 1e-12, so a zero vector gives zeros, never NaN.
inline Matrix3d MatrixFrom6D(const std::array<double, 6>& v, Rotation6D layout) {
  constexpr double kSmallNorm = 1e-12;
  const bool rows = layout == Rotation6D::kRows;
  const Vector3d a = rows ? Vector3d(v[0], v[1], v[2]) : Vector3d(v[0], v[2], v[4]);
  const Vector3d b = rows ? Vector3d(v[3], v[4], v[5]) : Vector3d(v[1], v[3], v[5]);
  const Vector3d first = a / std::max(a.norm(), kSmallNorm);
  const Vector3d rest = b - first.dot(b) * first;
  const Vector3d second = rest / std::max(rest.norm(), kSmallNorm);
  Matrix3d columns;
  columns << first, second, first.cross(second);
  return rows ? Matrix3d(columns.transpose()) : columns;
}

inline Matrix3d MatrixFromEuler(const Vector3d& angles, const EulerOrder& order) {
  Matrix3d rotation = Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) {
    rotation *=
        Eigen::AngleAxisd(angles[i], Vector3d::Unit(order.axes[static_cast<std::size_t>(i)])).toRotationMatrix();
  }
  return rotation;
}

}  // namespace mocurate
