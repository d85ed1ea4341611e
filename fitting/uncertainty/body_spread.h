#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

constexpr double kUnknownAngle = 3.289868133696453;  ///< variance of a uniform angle, pi^2 / 3

/// How far the end of a bone that nobody has measured lies from where the skeleton in the person's size has it:
/// standard deviation per axis, metres, of bones that start in the trunk (at a joint that is its own mirror image) and
/// of the others. Root mean squares over bodies of body_cc0 between its man and its woman (body_spread_test). People
/// are meant, whose joints are placed by one rule; a skeleton with other rules (its spine ends elsewhere) is farther
/// off.
inline constexpr double kTrunkSpread = 0.0055;
inline constexpr double kLimbSpread = 0.0025;
double SpreadOfBone(const Skeleton& skeleton, int bone);

/// How far joints are from the rest pose that no evidence turns, so that they are held there: standard deviation per
/// axis, radians, of those that carry a bone of 20 cm or more, and of wrists, ankles and necks.
inline constexpr double kLimbTurn = 1.0;
inline constexpr double kEndTurn = 0.3;

/// Covariance (F*J*6; xx xy xz yy yz zz, m^2) that the unmeasured part of the body, and joints that are held, add to
/// positions of joints; empty where all bones are measured: both their ends are seen in the tracks, in some frame.
/// Points of a tracker that are no joints (SkeletonTracks::place_spread) add where they may lie on the person. The
/// others are off by the spreads above, each on its own, and the pose follows them: what it makes up for, and what the
/// seen joints say about the bones between them, is taken off (consider covariance, Schmidt 1966, with the body's given
/// the evidence of one frame). So the hand beyond the last seen joint has the whole spread of its bone and of the
/// wrist, a spine between seen ends what both leave open, a seen joint next to nothing. A body is off by the same all
/// along: the pose is taken as one that is held, with every joint that the tracks show. Computed every 0.2 s, linear
/// between. `whole` is the whole clip at its solution, its kinematics up to date.
std::vector<float> CovarianceOfBody(const TrackWindow& whole);

}  // namespace mocurate
