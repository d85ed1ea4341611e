#pragma once

#include <string>

#include "core/motion/motion.h"

namespace mocurate {

/// Sixteen hexadecimal digits that say which motion it is: of the SHA-256 over its rate and its joints as a dataset
/// stores them (float32). The same in every file that holds the motion, whatever its id or label there.
std::string MotionFingerprint(const Motion& motion);

}  // namespace mocurate
