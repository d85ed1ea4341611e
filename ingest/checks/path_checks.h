#pragma once

#include <optional>

#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "core/quality/handedness.h"

namespace mocurate {

/// "units_contradiction", an error whose value is the factor: bones of a file and the path of its root (joint 0) that
/// are of two units, as that path is at least 8 times too long or too short for the body's steps (MeasureRootScale).
std::optional<Finding> CheckRootPath(const JointPositions& places, const BodyLandmarks& body);

}  // namespace mocurate
