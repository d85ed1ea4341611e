#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/pi.h"
#include "core/geometry/rotation.h"

namespace mocurate {
namespace {

constexpr double kGimbalLock =
    1e-12;  ///< cosine (Tait-Bryan) or sine (proper) of the middle angle below which it locks

Matrix3d AxisRotation(int axis, double angle) {
  return Eigen::AngleAxisd(angle, Vector3d::Unit(axis)).toRotationMatrix();
}

/// atan2 in (-pi, pi].
double Angle(double sine, double cosine) {
  const double angle = std::atan2(sine, cosine);
  return angle <= -kPi ? kPi : angle;
}

}  // namespace

Expected<EulerOrder> EulerOrder::Parse(std::string_view text) {
  const std::string hint = "write three of the letters X, Y, Z, the outermost rotation first, e.g. ZXY";
  const std::string quoted = "Euler order '" + std::string(text) + "'";
  if (text.size() != 3) {
    return Fail(ErrorCode::kConfig, quoted + " has " + std::to_string(text.size()) + " letters, not 3", {}, hint);
  }
  EulerOrder order;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = std::string_view("XYZxyz").find(text[i]);
    if (axis == std::string_view::npos) {
      return Fail(ErrorCode::kConfig, quoted + ": '" + std::string(1, text[i]) + "' is not an axis", {}, hint);
    }
    order.axes[i] = static_cast<int>(axis % 3);
    if (i > 0 && order.axes[i] == order.axes[i - 1]) {
      return Fail(ErrorCode::kConfig, quoted + " repeats the same axis twice in a row", {}, hint);
    }
  }
  return order;
}

bool operator==(const EulerOrder& a, const EulerOrder& b) { return a.axes == b.axes; }

Vector3d EulerFromMatrix(const Matrix3d& rotation, const EulerOrder& order) {
  const int i = order.axes[0];
  const int j = order.axes[1];
  const int k = 3 - i - j;
  const double sign = (j - i + 3) % 3 == 1 ? 1.0 : -1.0;  // of the permutation (i, j, k)
  const bool proper = order.axes[2] == i;
  const Matrix3d& r = rotation;

  // The first angle, then everything else from what remains without it: consistent however near the lock is.
  const double first_sine = proper ? r(j, i) : -sign * r(j, k);
  const double first_cosine = proper ? -sign * r(k, i) : r(k, k);
  const bool locked = std::hypot(first_sine, first_cosine) < kGimbalLock;
  const double first = locked ? Angle(sign * r(k, j), r(j, j)) : Angle(first_sine, first_cosine);
  const Matrix3d m = AxisRotation(i, -first) * r;

  double second = 0.0;
  double third = 0.0;
  if (proper) {
    second = std::clamp(std::atan2(-sign * m(k, i), m(i, i)), 0.0, kPi);
    if (locked) second = m(i, i) < 0.0 ? kPi : 0.0;
    third = Angle(-sign * m(j, k), m(j, j));
  } else {
    second = std::clamp(std::atan2(sign * m(i, k), m(k, k)), -0.5 * kPi, 0.5 * kPi);
    third = Angle(sign * m(j, i), m(j, j));
  }
  return Vector3d(first, second, locked ? 0.0 : third);
}

}  // namespace mocurate
