#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/rotation.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {

/// Gaussian of one frame's pose from other evidence, its priors included: the mean, and W with W^T W the information of
/// the errors d (root's translation, m; then Log(mean^T R) of each of `joints`, rad).
struct PoseGaussian {
  std::vector<int> joints;         ///< K joints whose rotation it knows, ascending
  Vector3d translation;            ///< m, world
  std::vector<Matrix3d> rotation;  ///< (K) parent_from_joint
  std::vector<double> rest;        ///< (K) information of the rest pose in it, 1/rad^2
  Eigen::MatrixXd whitening;       ///< W, (3 + 3 K)^2, lower triangle

  Eigen::Index size() const { return whitening.rows(); }
  /// d at the state's pose of a frame. Needs Update.
  Eigen::VectorXd Errors(const PoseState& state, int frame) const {
    Eigen::VectorXd errors(size());
    errors.head<3>() = state.position(frame, 0) - translation;
    for (std::size_t k = 0; k < joints.size(); ++k)
      errors.segment<3>(At(k)) = LogMatrix(rotation[k].transpose() * state.local(frame, joints[k]));
    return errors;
  }
  /// Derivative of the k-th joint's part of `errors` in its rotation vector. Needs Update with derivatives.
  Matrix3d Derivative(const Eigen::VectorXd& errors, const PoseState& state, int frame, std::size_t k) const {
    return RightJacobianInverse(errors.segment<3>(At(k))) * state.right_jacobian(frame, joints[k]);
  }
  static Eigen::Index At(std::size_t k) { return 3 + 3 * static_cast<Eigen::Index>(k); }
};

/// Covariances of the poses of a fit, one per frame: of the root's translation (m, world), then of each active joint's
/// rotation (rad, in the joint's frame: Log(R^T R')). As solved: neither scaled nor calibrated (PoseUncertainty).
struct PoseCovariances {
  std::vector<int> column;             ///< (J) first number of a joint's rotation; -1: none
  std::vector<Eigen::MatrixXd> frame;  ///< (F) n x n
  std::vector<double> rest_sigma;      ///< (J) rad, of the rest pose that they count as known

  bool empty() const { return frame.empty(); }
};

}  // namespace mocurate
