#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/motion/skeleton.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/terms/terms.h"

namespace mocurate {

constexpr double kUnknownAngle = 3.289868133696453;  ///< rad^2; variance of a uniform angle, pi^2 / 3 (numerical)

/// Metres, standard deviation per axis of a bone's end about its place on the skeleton in the person's size, for bones
/// that start in the trunk (at a joint on the midline). Root mean square over bodies of body_cc0 between its man and
/// its woman. Valid for people whose joints are placed by one rule; a skeleton with other rules (another end of the
/// spine) differs more. Source: sigma_test
inline constexpr double kTrunkSigma = 0.0055;
inline constexpr double kLimbSigma = 0.0025;  ///< Metres, the same for other bones. Source: sigma_test
double SpreadOfBone(const Skeleton& skeleton, int bone);

/// How far the person's body may be from the one that is fitted: standard deviations, metres and radians. The last
/// three (J) are empty where there is none of them.
struct BodyDeviations {
  std::vector<double> bone;             ///< (J) end of a bone relative to its start, per axis; 0: exact
  double capsule_end = 0.0;             ///< each end of a capsule in its joint's frame, per axis
  double capsule_radius = 0.0;          ///< of a capsule
  std::vector<bool> length_measured{};  ///< the end of the bone deviates only across the bone
  std::vector<double> point{};          ///< observed point of a joint from that joint, per axis
  std::vector<double> fixed{};          ///< rotation of a joint that is not an unknown, rad per axis

  BodyDeviations Times(double factor) const {
    BodyDeviations larger = *this;
    for (double& sigma : larger.bone) sigma *= factor;
    larger.capsule_end *= factor;
    larger.capsule_radius *= factor;
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

  /// Whether H can be inverted; if not, the covariances are those of a joint of which nothing is known.
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
