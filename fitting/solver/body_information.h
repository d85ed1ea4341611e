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

  BodyInformation& operator+=(const BodyInformation& other) {
    information += other.information;
    gradient += other.gradient;
    return *this;
  }
};

}  // namespace mocurate
