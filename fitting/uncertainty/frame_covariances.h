#pragma once

#include <Eigen/Core>
#include <functional>

#include "fitting/solver/track_equations.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// Covariances of the unknowns of a frame (TrackEquations), n x n: its own, with the next frame (own x next; empty for
/// the last frame), and the next frame's own (not to be read for the last).
struct FrameCovariance {
  const TrackEquations& track;
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
Status VisitCovariances(const TrackWindow& whole, const std::function<void(const FrameCovariance&)>& visit);

}  // namespace mocurate
