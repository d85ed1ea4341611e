#pragma once

#include "core/geometry/rigid.h"
#include "core/motion/skeleton.h"
#include "train/data/batches.h"
#include "train/options.h"

namespace mocurate {

/// Where a sample stands for a network (multiact.md B): network_from_world by the pose of its anchor, the last frame of
/// the previous motion. `rest_axes` of the skeleton (core/motion/heading.h), `root` world_from_root, `place` of the
/// root; `canonical_from_source` of the sample, whose inverse kNone takes.
RigidTransform NetworkFromWorld(CanonicalChoice choice, const Matrix3d& rest_axes, const Quaterniond& root,
                                const Vector3d& place, const RigidTransform& canonical_from_source);

/// Samples of three parts, padded to `frames`: joints and rotations as the network reads them, identities behind the
/// end. Clips must have parts of that many frames together at most.
MotionRows PlacedSamples(const TrainingSet& set, CanonicalChoice choice, int frames, const std::vector<int>& rows);

}  // namespace mocurate
