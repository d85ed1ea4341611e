#pragma once

#include <cmath>

#include "core/geometry/rotation.h"

namespace mocurate {

inline constexpr double kParallelRays =
    0.0175;  ///< sine of the angle, 1 degree, below which two rays determine no point

/// Normal equations of three unknowns, A x = b with A symmetric: sums of weighted squares, and their solution by
/// Cholesky, without a loop.
struct NormalEquations3 {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
  Vector3d right = Vector3d::Zero();

  /// weight * (slope . x - residual)^2 / 2 more.
  [[gnu::always_inline]] void Add(double weight, const Vector3d& slope, double residual) {
    const Vector3d weighted = weight * slope;
    xx += weighted.x() * slope.x();
    xy += weighted.x() * slope.y();
    xz += weighted.x() * slope.z();
    yy += weighted.y() * slope.y();
    yz += weighted.y() * slope.z();
    zz += weighted.z() * slope.z();
    right += residual * weighted;
  }
  /// weight * |x - origin|^2 / 2 across a unit direction more.
  [[gnu::always_inline]] void AddAcross(double weight, const Vector3d& direction, const Vector3d& origin) {
    xx += weight * (1.0 - direction.x() * direction.x());
    xy -= weight * direction.x() * direction.y();
    xz -= weight * direction.x() * direction.z();
    yy += weight * (1.0 - direction.y() * direction.y());
    yz -= weight * direction.y() * direction.z();
    zz += weight * (1.0 - direction.z() * direction.z());
    right += weight * (origin - direction.dot(origin) * direction);
  }
  /// False where A is not positive definite; then x is not set.
  [[gnu::always_inline]] bool Solve(Vector3d& x) const {
    const double a = std::sqrt(xx);
    const double b = xy / a, c = xz / a;
    const double d = std::sqrt(yy - b * b);
    const double e = (yz - b * c) / d;
    const double f = std::sqrt(zz - c * c - e * e);
    if (!(a > 0.0 && d > 0.0 && f > 0.0)) return false;  // false for NaN as well
    const double u = right.x() / a;
    const double v = (right.y() - b * u) / d;
    const double w = (right.z() - c * u - e * v) / f;
    x.z() = w / f;
    x.y() = (v - e * x.z()) / d;
    x.x() = (u - b * x.y() - c * x.z()) / a;
    return true;
  }
  Matrix3d Matrix() const {
    Matrix3d matrix;
    matrix << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return matrix;
  }
};

}  // namespace mocurate
