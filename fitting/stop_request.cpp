#include "fitting/stop_request.h"

#include "core/pipeline/worker.h"

namespace mocurate {

Status StopIfInterrupted(const std::string& doing) {
  if (!StopRequested()) return {};
  return Fail(ErrorCode::kInterrupted, "stopped on request", doing, "run again to continue");
}

}  // namespace mocurate
