#pragma once

#include <vector>

#include "core/motion/skeleton.h"

namespace mocurate {

/// (J) standard deviation of each joint's angle from the rest pose, radians: `rest_sigma` times the joint's mobility.
/// Limbs move freely; trunk, collars, feet and hands of a skeleton with these names little, so that they do not absorb
/// the error of a capsule body.
std::vector<double> RestPoseSigmas(const Skeleton& skeleton, double rest_sigma);

/// Share of the rest pose's information (1 / s^2, `rest`) that a frame counts for a step to a neighbour whose process
/// noise has the information `step` (1 / q, of that same axis). People keep a posture, so that the rest pose counts
/// once and not anew in every frame: rest pose and process noise form one stationary process with standard deviation s
/// (Ornstein-Uhlenbeck, rho = e^-t with sinh t = q / (2 s^2)). Its frames count (1 - rho) / (1 + rho) / 2 for each
/// neighbour, and 1/2 where they have none (kRestAtAnEnd): 1 for a frame alone.
inline constexpr double kRestAtAnEnd = 0.5;
double RestShareOfStep(double rest, double step);

/// (J) whether a joint rotates freely against the bone above, as hips, knees, shoulders and elbows do: distances across
/// it are not constant.
std::vector<bool> SwingingJoints(const Skeleton& skeleton);

}  // namespace mocurate
