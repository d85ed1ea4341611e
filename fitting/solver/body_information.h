#pragma once

#include <Eigen/Core>

#include "core/geometry/rotation.h"

namespace mocurate {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Information of points fixed to one rigid body about its motion: Gauss-Newton information (6 x 6) and gradient (6) of
/// 1/2 sum e' W e in the body's twist (v, w), v at an origin o. A point at p, relative to o, moves by v + w x p. Bodies
/// that move together are added: the rotation above a subtree needs only the subtree's sum (composite rigid body
/// method, Featherstone 2008, section 6.3, with information for inertia).
struct BodyInformation {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();

  /// A point of isotropic weight w; `pull` = W e.
  void AddPoint(const Vector3d& p, double weight, const Vector3d& pull) {
    const Matrix3d hat = weight * Hat(p);
    information.topLeftCorner<3, 3>().diagonal().array() += weight;
    information.topRightCorner<3, 3>() -= hat;
    information.bottomLeftCorner<3, 3>() += hat;
    information.bottomRightCorner<3, 3>() +=
        (weight * p.squaredNorm()) * Matrix3d::Identity() - weight * p * p.transpose();
    gradient.head<3>() += pull;
    gradient.tail<3>() += p.cross(pull);
  }
  /// A point of any weight W (symmetric 3 x 3).
  void AddPoint(const Vector3d& p, const Matrix3d& weight, const Vector3d& pull) {
    const Matrix3d hat = Hat(p);
    const Matrix3d moment = weight * hat;
    information.topLeftCorner<3, 3>() += weight;
    information.topRightCorner<3, 3>() -= moment;
    information.bottomLeftCorner<3, 3>() -= moment.transpose();
    information.bottomRightCorner<3, 3>() += hat.transpose() * moment;
    gradient.head<3>() += pull;
    gradient.tail<3>() += p.cross(pull);
  }
  /// A recorded rotation of weight W (symmetric 3 x 3, of the body's rotation w); `pull` = W e.
  void AddRotation(const Matrix3d& weight, const Vector3d& pull) {
    information.bottomRightCorner<3, 3>() += weight;
    gradient.tail<3>() += pull;
  }
  BodyInformation& operator+=(const BodyInformation& other) {
    information += other.information;
    gradient += other.gradient;
    return *this;
  }
};

/// Information that couples a body's twist in one frame (rows) and in another (columns): a point at p here and q there,
/// of isotropic weight: weight * X(p)' X(q), X(p) = [I, -Hat(p)].
inline Matrix6d CrossInformation(const Vector3d& p, const Vector3d& q, double weight) {
  Matrix6d information;
  information.topLeftCorner<3, 3>() = weight * Matrix3d::Identity();
  information.topRightCorner<3, 3>() = -weight * Hat(q);
  information.bottomLeftCorner<3, 3>() = weight * Hat(p);
  information.bottomRightCorner<3, 3>() = weight * (p.dot(q) * Matrix3d::Identity() - q * p.transpose());
  return information;
}

}  // namespace mocurate
