#pragma once

#include <vector>

#include "fitting/solver/track_problem.h"

namespace mocurate {

constexpr double kUnknownAngle = 3.289868133696453;  ///< rad^2; variance of a uniform angle, pi^2 / 3 (numerical)

/// Metres, standard deviation per axis of an unmeasured bone's end about its place on the skeleton in the person's
/// size, for bones that start in the trunk (at a joint on the midline). Root mean square over bodies of body_cc0
/// between its man and its woman. Valid for people whose joints are placed by one rule; a skeleton with other rules
/// (another end of the spine) differs more. Source: sigma_test
inline constexpr double kTrunkSigma = 0.0055;
inline constexpr double kLimbSigma = 0.0025;  ///< Metres, the same for other bones. Source: sigma_test
double SpreadOfBone(const Skeleton& skeleton, int bone);

/// Radians, standard deviation per axis of joints that no evidence rotates and that are fixed in the rest pose, and
/// that carry a bone of 20 cm or more.
inline constexpr double kLimbRotation = 1.0;
inline constexpr double kEndRotation = 0.3;  ///< Radians, the same for wrists, ankles and necks.

/// Covariance (F*J*6; xx xy xz yy yz zz, m^2) of joint positions from the unmeasured part of the body and from fixed
/// joints; empty where all bones are measured: some frame of the tracks shows both ends. A tracker's points that are
/// not joints (SkeletonTracks::place_sigma) add the covariance of their places. Each unmeasured bone varies
/// independently by the standard deviations above, and the pose follows (consider covariance, Schmidt 1966, given the
/// evidence of one frame). The result is what the pose does not compensate for and observed joints do not determine.
/// The hand beyond the last observed joint has all of its bone's and the wrist's uncertainty, an observed joint almost
/// none. A body's error is constant: the pose is that of a fixed frame with every joint that the tracks show. Computed
/// every 0.2 s, linear between. `whole` is the whole clip at its solution, kinematics up to date.
std::vector<float> CovarianceOfBody(const TrackProblem& whole);

inline constexpr double kShortestBone_m = 1e-3;  ///< shorter bones are between joints that coincide by definition

/// Adds the second-order effect of large rotations along a bone to covariances of positions (F*J*6; xx xy xz yy yz zz,
/// m^2). First order has no uncertainty along the bone. With direction variance s rad^2 over both axes across it, the
/// end of a bone of length r comes nearer by r (1 - cos): mean square r^2 s^2 / 2, and 4/3 r^2 for a uniform direction.
/// s follows from the difference of the end's and the start's covariance, so joints with other evidence get none;
/// descendants of an end follow it. Joints observed in their frame are unchanged.
void AddSecondOrderCovariance(const TrackProblem& whole, std::vector<float>& position_cov);

/// Covariance of each joint's frame orientation (3 x 3 in the joint's frame, rad^2; (J)) from the uncertain position of
/// each bone's end relative to its start: `variance` (J), m^2 per axis; 0: the bone has no information.
std::vector<Matrix3d> FrameOrientationByBones(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                              const std::vector<double>& variance);

/// Covariance of each joint's frame orientation between bodies (3 x 3 in the joint's frame, rad^2; (J)). Rotations
/// refer to a skeleton's rest pose, and the ends of people's bones vary by the standard deviations of body_sigma.h. The
/// bones at a joint therefore rotate its frame by that deviation over their ends' distance from the axis. Places of a
/// tracker's points that are not joints add their own. Only bones with both ends observed count. About a joint's only
/// bone there is no such rotation (that twist is in the prior), unless the bone ends in a hinge: then the carrying
/// angle of forearms and shins.
std::vector<Matrix3d> FrameOrientationCovariance(const TrackProblem& whole);

}  // namespace mocurate
