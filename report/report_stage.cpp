#include "core/base/file.h"
#include "report/options.h"
#include "report/stages.h"

namespace mocurate {

Expected<StageOutcome> ReportStage(const StageRequest& request) {
  std::string text;
  for (const StageInput& input : request.inputs) {
    if (input.role != "run") continue;
    const auto run = ReadFile(input.path);
    if (!run) return Forward(run);
    text = *run;
  }
  if (Status written = WriteFile(request.output, "<!doctype html><meta charset=utf-8><pre>" + text + "</pre>\n"); !written) {
    return Forward(written);
  }
  return StageOutcome();
}

}  // namespace mocurate
