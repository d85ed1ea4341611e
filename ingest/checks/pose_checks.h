#pragma once

#include <optional>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/amass.h"
#include "core/motion/motion.h"

namespace mocurate {

/// "frozen_pose": frames on end in which every rotation of the body's joints (the root's and the hands' aside) is what
/// it was to the last digit, while the root is carried on: `trans` changes in at least half of the steps. 5 frames or
/// more are reported, at most 20 spans; value: frames; an error from half of the clip on. Fitted poses of who stands
/// still differ in every frame, and who repeats as a whole is "frozen_frames" (core/quality/repeats.h). Of rotations
/// that are all 0, which no fit gives, a single such frame is reported, wherever the root is.
std::vector<Finding> CheckFrozenPoses(const Amass& amass);

/// "path_missing": `trans` is 0 0 0 in every frame, 5 or more, while joints turn. Value: frames.
std::optional<Finding> CheckTranslations(const Amass& amass);

/// "units_contradiction" where the markers are a power of ten larger or smaller than the body that poses and `trans`
/// give, `posed` (frames, joints; metres): `marker_data` is of another unit, and the body is sound. Value: how many
/// times.
std::optional<Finding> CheckMarkers(const Amass& amass, const JointPositions& posed);

/// What is wrong with the rotations of a clip of `humanact12poses.pkl`, the first of: CheckAngleUnits,
/// CheckFrozenPoses, "pose_contradiction". The last is a warning whose value is degrees: 'poses' that are not those of
/// 'joints3D', as of another clip, of other frames, of the other side. Turned back by the rotation of its joint a bone
/// of one body lies as at rest, in every frame the same way. Reported for a limb's bone that does not in one frame of
/// ten or more; of several the one that is furthest off. Frames: from the first to the last of them. The law is any
/// body's, whatever its bone lengths.
std::optional<Finding> CheckGivenRotations(const HumanAct12Clip& clip);

}  // namespace mocurate
