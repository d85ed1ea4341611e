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
/// still differ in every frame, and who repeats as a whole is "frozen_frames" (core/quality/checks.h). Of rotations
/// that are all 0, which no fit gives, a single such frame is reported, wherever the root is.
std::vector<Finding> CheckFrozenPoses(const Amass& amass);

/// "path_missing": `trans` is 0 0 0 in every frame, 5 or more, while joints turn. Value: frames.
std::optional<Finding> CheckTranslations(const Amass& amass);

/// "units_contradiction" where the markers are a power of ten larger or smaller than the body that poses and `trans`
/// give, `posed` (frames, joints; metres): `marker_data` is of another unit, and the body is sound. Value: how many
/// times.
std::optional<Finding> CheckMarkers(const Amass& amass, const JointPositions& posed);

}  // namespace mocurate
