#pragma once

#include <string>

#include "core/motion/motion.h"

namespace mocurate {

/// States of all joints (rows) over the frames as one SVG; empty for a motion without states.
std::string StateMapSvg(const Motion& motion);

}  // namespace mocurate
