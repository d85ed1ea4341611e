#pragma once

#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Error kInterrupted once this worker received a stop request; long loops check it in every frame.
Status StopIfInterrupted(const std::string& doing);

}  // namespace mocurate
