#include "fitting/stop_request.h"

#include "core/pipeline/worker.h"

namespace mocurate {

Status GoOnUnlessStopped(const std::string& doing) {
  if (!StopRequested()) return {};
  return Fail(ErrorCode::kInterrupted, "stopped on request", doing, "run again to go on");
}

}  // namespace mocurate
