#pragma once

#include "core/geometry/rigid.h"
#include "core/motion/skeleton.h"
#include "train/data/batches.h"
#include "train/options.h"

namespace mocurate {

/// Pose of a sample for a network (multiact.md B): network_from_world from its anchor, the last frame of the previous
/// motion. `rest_axes` of the skeleton (core/motion/heading.h), `root` world_from_root, `place` of the root;
/// `canonical_from_source` of the sample, whose inverse kNone uses.
RigidTransform NetworkFromWorld(CanonicalChoice choice, const Matrix3d& rest_axes, const Quaterniond& root,
                                const Vector3d& place, const RigidTransform& canonical_from_source);

/// Samples of three parts, padded to `frames`: joints and rotations in the network's frame, identities after the end.
/// The parts of a clip must have at most that many frames together.
MotionRows PlacedSamples(const TrainingSet& set, CanonicalChoice choice, int frames, const std::vector<int>& rows);

}  // namespace mocurate
