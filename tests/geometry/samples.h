#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/geometry/rotation.h"

namespace mocurate::test {

constexpr double kPi = 3.14159265358979323846;

inline Vector3d DrawVector(Random& random) { return Vector3d(random.Normal(), random.Normal(), random.Normal()); }

inline Vector3d DrawDirection(Random& random) { return DrawVector(random).normalized(); }

inline Quaterniond DrawRotation(Random& random) {
  const double w = random.Normal();
  const Vector3d v = DrawVector(random);
  return Quaterniond(w, v.x(), v.y(), v.z()).normalized();
}

/// Axes of every kind: coordinate axes both ways, diagonals, with zero components, random.
inline std::vector<Vector3d> Axes() {
  std::vector<Vector3d> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(Vector3d::Unit(i));
    axes.push_back(-Vector3d::Unit(i));
  }
  axes.push_back(Vector3d(1, 1, 1).normalized());
  axes.push_back(Vector3d(-1, 1, 0).normalized());
  axes.push_back(Vector3d(0, -1, 1).normalized());
  Random random(1, "rotation axes");
  for (int i = 0; i < 40; ++i) axes.push_back(DrawDirection(random));
  return axes;
}

/// Angles below pi where formulas break: zero, tiny, around every series' border, ordinary, near pi.
inline std::vector<double> AnglesBelowPi() {
  return {0.0,  1e-300, 1e-160, 1e-20, 1e-12, 1e-8,       9.99e-5,    1.01e-4,     0.01,       0.0499,
          0.05, 0.3,    1.0,    1.5,   2.5,   kPi - 1e-2, kPi - 1e-6, kPi - 1e-10, kPi - 1e-12};
}

inline std::vector<Vector3d> RotationVectorsBelowPi() {
  std::vector<Vector3d> vectors;
  for (const double angle : AnglesBelowPi()) {
    for (const Vector3d& axis : Axes()) vectors.push_back(angle * axis);
  }
  return vectors;
}

/// The same and beyond: exactly pi, above, multiples of 2 pi.
inline std::vector<Vector3d> RotationVectors() {
  std::vector<Vector3d> vectors = RotationVectorsBelowPi();
  for (const double angle : {kPi, kPi + 1e-9, 4.0, 2.0 * kPi - 1e-3, 2.0 * kPi, 7.5, 40.0}) {
    for (const Vector3d& axis : Axes()) vectors.push_back(angle * axis);
  }
  return vectors;
}

/// Largest difference of two matrices or vectors; NaN counts as infinite.
template <class A, class B>
double Difference(const A& a, const B& b) {
  const double difference = (a - b).cwiseAbs().maxCoeff();
  return (a - b).array().isFinite().all() ? difference : HUGE_VAL;
}

inline std::string Text(const Vector3d& v) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g ", v[i]);
    text += buffer;
  }
  return text;
}

inline bool IsRotation(const Matrix3d& matrix, double tolerance = 1e-14) {
  return Difference(matrix * matrix.transpose(), Matrix3d::Identity()) < tolerance && matrix.determinant() > 0.0;
}

}  // namespace mocurate::test
