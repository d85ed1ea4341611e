#pragma once

#include <map>
#include <string>

#include "core/pipeline/stage.h"

namespace mocurate {

/// Main loop of a worker program: reads length-prefixed JSON requests from stdin, answers on stdout, logs on stderr.
/// Ends when stdin closes; dies with its parent. Returns the exit code.
int RunWorker(const std::map<std::string, StageFunction>& stages);

/// True once SIGINT or SIGTERM asked this worker to stop early; long stages (training) look at it between steps, save
/// to `scratch` and return kInterrupted.
bool StopRequested();

/// Reports to the runner how far an item is (0 to 1), with a short text; shown on a terminal only.
void ReportProgress(double fraction, const std::string& text);

}  // namespace mocurate
