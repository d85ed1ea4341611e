#pragma once

#include "ingest/sense/inspect.h"

namespace mocurate {

/// Asks the program mocurate-video beside this one. Error kMissingOnHost where it is not there or does not start; a
/// file that it dies of, or says nothing of for 60 s, is kMalformed, and the others are asked again.
VideoProbe AskVideoProgram();

}  // namespace mocurate
