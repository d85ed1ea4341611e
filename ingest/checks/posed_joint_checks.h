#pragma once

#include <optional>

#include "core/base/finding.h"
#include "core/formats/humanact12_pickle.h"

namespace mocurate {

/// "pose_contradiction" of a clip of `humanact12poses.pkl`, a warning whose value is degrees: 'poses' that are not
/// those of 'joints3D', as of another clip, of other frames, of the other side. Turned back by the rotation of its
/// joint a bone of one body lies as at rest, in every frame the same way. Reported for a limb's bone that does not in
/// one frame of ten or more; of several the one that is furthest off. Frames: from the first to the last of them. The
/// law is any body's, whatever its bone lengths.
std::optional<Finding> CheckPosedJoints(const HumanAct12Clip& clip);

/// What is wrong with the rotations of a clip, the first of: CheckAngleUnits, CheckFrozenPoses, CheckPosedJoints.
std::optional<Finding> CheckGivenRotations(const HumanAct12Clip& clip);

}  // namespace mocurate
