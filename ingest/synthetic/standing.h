#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "ingest/synthetic/pose.h"

namespace mocurate {

/// A body in these poses, one per frame, moved so that the foot that carries the weight stays in place. Skeletons
/// kinect20 and smpl24 (by their ankles and feet). `start` is the starting point in frame 0: x, z of the pelvis, y of
/// the floor. The body never falls faster than gravity allows. Canonical axes, metres.
Motion MoveBody(const SkeletonPtr& skeleton, const std::vector<double>& bone_length, FrameRate rate,
                const std::vector<Pose>& poses, const Vector3d& start);

}  // namespace mocurate
