#pragma once

#include <vector>

#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// (J) how far each joint usually is from the rest pose, radians: `rest_spread` times the joint's mobility. Limbs move
/// freely; the trunk, collars, feet and hands of a skeleton with these names little, so that they do not take up the
/// error of a capsule body.
std::vector<double> RestSpreads(const Skeleton& skeleton, double rest_spread);

/// (J) the same for joint tracks: `rest_spread` where a joint is ever seen; what a joint usually turns, where its place
/// is never seen and nobody recorded its rotation, for what hangs from it tells little of it (three joints of a spine
/// between hips and shoulders could turn against each other).
std::vector<double> RestSpreads(const SkeletonTracks& tracks, double rest_spread);

/// (J) whether a joint turns freely against the bone above, as hips, knees, shoulders and elbows do: distances across
/// it tell no body.
std::vector<bool> SwingingJoints(const Skeleton& skeleton);

}  // namespace mocurate
