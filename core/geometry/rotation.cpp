#include "core/geometry/rotation.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/pi.h"

namespace mocurate {
namespace {

/// (1 - cos t) / t^2.
double CosineFactor(double angle) {
  if (angle < 1e-4) return 0.5 - angle * angle / 24.0;
  const double sine = std::sin(0.5 * angle) / angle;
  return 2.0 * sine * sine;
}

/// (t - sin t) / t^3.
double SineFactor(double angle) {
  const double square = angle * angle;
  if (angle < 0.05) return 1.0 / 6.0 - square / 120.0 + square * square / 5040.0 - square * square * square / 362880.0;
  return (angle - std::sin(angle)) / (square * angle);
}

/// (1 - t/2 cot(t/2)) / t^2.
double InverseFactor(double angle) {
  const double square = angle * angle;
  if (angle < 0.05)
    return 1.0 / 12.0 + square / 720.0 + square * square / 30240.0 + square * square * square / 1209600.0;
  const double half = 0.5 * angle;
  return (1.0 - half * std::cos(half) / std::sin(half)) / square;
}

/// Whether the first component that differs from zero by more than rounding is negative (unit axes).
bool PointsBackwards(const Vector3d& axis) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis[i]) > 1e-12) return axis[i] < 0.0;
  }
  return false;
}

/// A unit vector perpendicular to a unit vector, always the same one.
Vector3d Perpendicular(const Vector3d& unit) {
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(unit[i]) < std::abs(unit[least])) least = i;
  }
  return unit.cross(Vector3d::Unit(least)).normalized();
}

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

Matrix3d Hat(const Vector3d& vector) {
  Matrix3d hat;
  hat << 0.0, -vector.z(), vector.y(), vector.z(), 0.0, -vector.x(), -vector.y(), vector.x(), 0.0;
  return hat;
}

Quaterniond ExpQuaternion(const Vector3d& rotation_vector) {
  const double angle = rotation_vector.stableNorm();
  const double factor = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  Quaterniond rotation;
  rotation.w() = std::cos(0.5 * angle);
  rotation.vec() = factor * rotation_vector;
  return rotation;
}

Matrix3d ExpMatrix(const Vector3d& rotation_vector) { return ExpQuaternion(rotation_vector).toRotationMatrix(); }

Vector3d LogQuaternion(const Quaterniond& rotation) {
  const double sine = rotation.vec().stableNorm();
  if (sine == 0.0) return Vector3d::Zero();
  const double angle = 2.0 * std::atan2(sine, std::abs(rotation.w()));
  const Vector3d axis = rotation.vec() / sine;
  if (angle >= kPi) return (PointsBackwards(axis) ? -kPi : kPi) * axis;
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  return sign * (angle / sine) * rotation.vec();
}

Vector3d LogMatrix(const Matrix3d& rotation) { return LogQuaternion(Quaterniond(rotation)); }

Matrix3d RightJacobian(const Vector3d& rotation_vector) {
  const double angle = rotation_vector.stableNorm();
  const Matrix3d hat = Hat(rotation_vector);
  return Matrix3d::Identity() - CosineFactor(angle) * hat + SineFactor(angle) * hat * hat;
}

Matrix3d RightJacobianInverse(const Vector3d& rotation_vector) {
  const Matrix3d hat = Hat(rotation_vector);
  return Matrix3d::Identity() + 0.5 * hat + InverseFactor(rotation_vector.stableNorm()) * hat * hat;
}

Vector3d UnwrapNear(const Vector3d& rotation_vector, const Vector3d& previous) {
  double angle = rotation_vector.stableNorm();
  Vector3d axis = Vector3d::Zero();
  if (angle > 1e-12) {
    axis = rotation_vector / angle;
  } else {
    // The axis of the identity is undefined: multiples of 2 pi are applied along the previous axis.
    const double length = previous.stableNorm();
    if (length < kPi) return rotation_vector;
    axis = previous / length;
    angle = 0.0;
  }
  const double turns = std::round((axis.dot(previous) - angle) / (2.0 * kPi));
  return turns == 0.0 ? rotation_vector : Vector3d((angle + 2.0 * kPi * turns) * axis);
}

double AngleBetween(const Quaterniond& a, const Quaterniond& b) {
  const Quaterniond b_from_a = a.conjugate() * b;
  return 2.0 * std::atan2(b_from_a.vec().stableNorm(), std::abs(b_from_a.w()));
}

Quaterniond Slerp(const Quaterniond& a, const Quaterniond& b, double fraction) {
  if (fraction == 0.0) return a;
  if (fraction == 1.0) return a.dot(b) < 0.0 ? Quaterniond(-b.coeffs()) : b;
  return (a * ExpQuaternion(fraction * LogQuaternion(a.conjugate() * b))).normalized();
}

Matrix3d NearestRotation(const Matrix3d& matrix) {
  const Eigen::JacobiSVD<Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d signs = Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Quaterniond SwingBetween(const Vector3d& from, const Vector3d& to) {
  const Vector3d a = from.stableNormalized();
  const Vector3d b = to.stableNormalized();
  const Vector3d cross = a.cross(b);
  const double sine = cross.stableNorm();
  const double cosine = a.dot(b);
  if (sine < 1e-14 && cosine < 0.0) {
    const Vector3d axis = Perpendicular(a);
    return Quaterniond(0.0, axis.x(), axis.y(), axis.z());
  }
  if (sine == 0.0) return Quaterniond::Identity();
  // Near a rotation by pi the cross product is noisy; the axis must be perpendicular to `from`.
  Vector3d axis = cross / sine;
  axis = (axis - axis.dot(a) * a).normalized();
  return ExpQuaternion(std::atan2(sine, cosine) * axis);
}

std::array<double, 6> Matrix6D(const Matrix3d& r, Rotation6D layout) {
  if (layout == Rotation6D::kRows) return {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2)};
  return {r(0, 0), r(0, 1), r(1, 0), r(1, 1), r(2, 0), r(2, 1)};
}

void MakeSignContinuous(Quaterniond* first, std::size_t count, std::size_t stride) {
  for (std::size_t i = 0; i < count; ++i) {
    Quaterniond& here = first[i * stride];
    const double agreement = i == 0 ? here.w() : first[(i - 1) * stride].dot(here);
    if (agreement < 0.0) here.coeffs() = -here.coeffs();
  }
}

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
