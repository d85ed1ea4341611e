#pragma once

#include <vector>

#include "core/base/random.h"
#include "core/motion/motion.h"
#include "train/options.h"

namespace mocurate {

/// The joints evenly spaced in time, first and last frame kept; a single frame is repeated.
JointPositions ResampledJoints(const Motion& motion, int frames);

/// Input of a recogniser for a motion, (frames, 3J) float32, joint-major: all joints with the root of the first frame
/// at the origin. kResample: the whole motion resampled to `frames`, `random` unused. kCrop: Action2Motion's window
/// (a2m_actor.md A.7) with a start drawn from `random`. kWhole: the first frames; after the end of the motion zeros
/// minus the first root (multiact.md E).
std::vector<float> RecogniserInput(const Motion& motion, RecogniserInputKind kind, int frames, Random& random);

/// Changes one motion of (frames, 3J) in place: yaw, size and noise; its first root stays at the origin.
void AugmentSpace(const AugmentationOptions& options, const Skeleton& skeleton, int frames, Random& random,
                  std::vector<float>& motion);

/// Cuts both ends and warps time of (frames, joints, 3): same number of frames, linear in between.
JointPositions AugmentTime(const AugmentationOptions& options, const JointPositions& joints, Random& random);

}  // namespace mocurate
