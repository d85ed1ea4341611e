#pragma once

#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Error kInterrupted once this worker was asked to stop; long loops look at it from frame to frame.
Status GoOnUnlessStopped(const std::string& doing);

}  // namespace mocurate
