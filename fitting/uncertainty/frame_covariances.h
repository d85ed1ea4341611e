#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "fitting/solver/body_information.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/solver/track_problem.h"

namespace mocurate {

/// Covariances of the unknowns of a frame (PoseColumns), n x n: its own, with the next frame (own x next; empty for
/// the last frame), and the next frame's own (not to be read for the last).
struct FrameCovariance {
  const PoseColumns& columns;
  int frame = 0;
  const Eigen::MatrixXd& own;
  const Eigen::MatrixXd& with_next;
  const Eigen::MatrixXd& next;
  /// Information that couples its unknowns with the next frame's (own x next): that of the process noise, negative. Not
  /// to be read for the last.
  Eigen::Ref<const Eigen::MatrixXd> tie;
};

/// Calls `visit` for every frame of a solved fit with blocks of the inverse of the Gauss-Newton matrix at the solution.
/// They are computed in parts with some context, so that memory does not grow with the clip; in a part the last frame
/// comes first. `whole` is the whole clip; its state's kinematics are updated. Error kInconsistent if the matrix cannot
/// be factored.
Status VisitCovariances(const TrackProblem& whole, const std::function<void(const FrameCovariance&)>& visit);

/// Propagation of the rotations of a frame to the positions below them, with covariance: a point at p, relative to the
/// root, moves by X(p) times the twist of its carrier, X(p) = [I, -Hat(p)], which sums the translation and every
/// rotation above. Covariances of positions follow joint by joint, without derivatives by all unknowns.
class TwistPropagation {
 public:
  /// The state's kinematics must be up to date, derivatives included.
  TwistPropagation(const PoseState& state, const PoseColumns& columns, int frame);

  /// Covariance (6 x 6) of the twists of each joint's carrier with those in another frame (or the same), from that of
  /// the unknowns (n x n, rows of this frame, columns of the other). (J)
  std::vector<Matrix6d> CovarianceWith(const TwistPropagation& other, const Eigen::MatrixXd& unknowns) const;

  /// X(p) of a joint.
  Matrix36d PositionDerivative(int joint) const;

 private:
  const PoseState& state_;
  const PoseColumns& columns_;
  int frame_;
  std::vector<Twist> twist_;  ///< of each joint's rotation vector; not set where it has none. (J)
};

}  // namespace mocurate
