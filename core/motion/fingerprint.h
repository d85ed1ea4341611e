#pragma once

#include <string>

#include "core/motion/motion.h"

namespace mocurate {

/// Sixteen hexadecimal digits that identify a motion: of the SHA-256 over its rate and its joints as a dataset stores
/// them (float32). Equal in every file that holds the motion, with any id or label.
std::string MotionFingerprint(const Motion& motion);

}  // namespace mocurate
