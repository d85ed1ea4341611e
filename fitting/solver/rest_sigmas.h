#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

inline constexpr double kTypicalSigma = 1.0;  ///< rad from the rest pose, of hips, knees, shoulders and elbows

/// (J) standard deviation of each joint's angle from the rest pose, radians: `rest_sigma` times the joint's mobility.
/// Limbs move freely; trunk, collars, feet and hands of a skeleton with these names little, so that they do not absorb
/// the error of a capsule body.
std::vector<double> RestPoseSigmas(const Skeleton& skeleton, double rest_sigma);

/// (J) the same for joint tracks: `rest_sigma` where a joint is ever observed; the joint's typical angle where neither
/// its position nor its rotation is, as its descendants determine little of it (three joints of a spine between hips
/// and shoulders could rotate against each other).
std::vector<double> RestPoseSigmas(const SkeletonTracks& tracks, double rest_sigma);

/// (J) whether a joint rotates freely against the bone above, as hips, knees, shoulders and elbows do: distances across
/// it are not constant.
std::vector<bool> SwingingJoints(const Skeleton& skeleton);

}  // namespace mocurate
