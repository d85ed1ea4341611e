#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/terms/terms.h"

namespace mocurate {

/// How far the person's body may be from the one that is fitted: standard deviations, metres.
struct BodyDeviations {
  std::vector<double> bone;     ///< (J) end of a bone relative to its start, per axis; 0: exact
  double capsule_end = 0.0;     ///< each end of a capsule in its joint's frame, per axis
  double capsule_radius = 0.0;  ///< of a capsule

  BodyDeviations Times(double factor) const {
    BodyDeviations larger{bone, factor * capsule_end, factor * capsule_radius};
    for (double& sigma : larger.bone) sigma *= factor;
    return larger;
  }
};

/// What a body that is not the person's does to a fitted pose: a consider covariance (Schmidt 1966). The body is held
/// fixed in the fit, the pose follows it to explain the same evidence, x(b) = x - H^-1 G b with H the information of a
/// frame's own terms and G that between pose and body. A body's error is the same in all frames, so that process noise
/// does not resist it.
class BodyResponse {
 public:
  /// Of the frame `index` of the terms, at the state's pose; kinematics up to date, derivatives included.
  BodyResponse(const PoseTerms& terms, const PoseState& state, int index, const BodyDeviations& deviations);

  /// Whether H can be inverted; if not, nothing is known.
  bool known() const { return known_; }
  /// (J) covariance that it adds to positions of joints in the world, m^2.
  const std::vector<Matrix3d>& position() const { return position_; }
  /// (J) the same for rotations, in the joint's own frame, rad^2.
  const std::vector<Matrix3d>& rotation() const { return rotation_; }

 private:
  bool known_ = false;
  std::vector<Matrix3d> position_, rotation_;
};

}  // namespace mocurate
