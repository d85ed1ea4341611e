#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Rotations are Hamilton unit quaternions; a rotation vector is axis times angle in radians. Active rotations:
/// y = R x. Stored order of four numbers is always (w, x, y, z); Eigen's own memory order is (x, y, z, w).

/// Skew matrix: Hat(a) * b = a x b.
Matrix3d Hat(const Vector3d& vector);

/// Rotation of a rotation vector. Exact to rounding at 0 (series) and for any angle.
Quaterniond ExpQuaternion(const Vector3d& rotation_vector);
Matrix3d ExpMatrix(const Vector3d& rotation_vector);

/// Rotation vector with angle in [0, pi]. Exact to rounding at 0 and at pi; at exactly pi the axis whose first non-zero
/// component is positive.
Vector3d LogQuaternion(const Quaterniond& rotation);
Vector3d LogMatrix(const Matrix3d& rotation);

/// Right Jacobian of SO(3): Exp(w + d) ~ Exp(w) Exp(J_r(w) d), and its inverse (|w| < 2 pi).
Matrix3d RightJacobian(const Vector3d& rotation_vector);
Matrix3d RightJacobianInverse(const Vector3d& rotation_vector);

/// The rotation vector of the same rotation that lies nearest to `previous` (adds multiples of 2 pi along the axis).
Vector3d UnwrapNear(const Vector3d& rotation_vector, const Vector3d& previous);

/// Angle between two rotations, radians in [0, pi].
double AngleBetween(const Quaterniond& a, const Quaterniond& b);

/// Shortest-arc interpolation, 0 gives a, 1 gives b.
Quaterniond Slerp(const Quaterniond& a, const Quaterniond& b, double fraction);

/// Nearest rotation to any matrix in the Frobenius sense (SVD, determinant +1).
Matrix3d NearestRotation(const Matrix3d& matrix);

/// Smallest rotation that takes direction `from` to direction `to` (lengths are ignored). For opposite directions a
/// rotation by pi about an axis perpendicular to `from`, always the same one.
Quaterniond SwingBetween(const Vector3d& from, const Vector3d& to);

/// Which two vectors of the matrix a 6D representation holds: the released codes differ (ACTOR: rows, MultiAct's
/// decoder: columns, interleaved).
enum class Rotation6D { kRows, kColumns };

/// kRows: (R00 R01 R02 R10 R11 R12). kColumns: (R00 R01 R10 R11 R20 R21), the first two columns interleaved.
std::array<double, 6> Matrix6D(const Matrix3d& rotation, Rotation6D layout);

/// Axes of an Euler sequence, e.g. EulerOrder::Parse("ZXY"): R = R_z(a0) R_x(a1) R_y(a2), intrinsic, right-handed.
struct EulerOrder {
  std::array<int, 3> axes{0, 1, 2};
  static Expected<EulerOrder> Parse(std::string_view text);
};
bool operator==(const EulerOrder& a, const EulerOrder& b);

/// Angles in (-pi, pi]; the middle one in [-pi/2, pi/2] (Tait-Bryan) or [0, pi] (proper). In gimbal lock the third is
/// 0.
Vector3d EulerFromMatrix(const Matrix3d& rotation, const EulerOrder& order);

/// Flips signs so that consecutive quaternions of one joint lie in one hemisphere; the first keeps w >= 0.
void MakeSignContinuous(Quaterniond* first, std::size_t count, std::size_t stride);

}  // namespace mocurate
