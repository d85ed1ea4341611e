#pragma once

#include "ingest/inspect/inspect.h"

namespace mocurate {

/// Runs the program mocurate-video beside this one. Error kMissingOnHost if it is missing or does not start. A file
/// that crashes it, or has no answer within 60 s, is kMalformed; the others are requested again.
VideoProbe AskVideoProgram();

}  // namespace mocurate
