#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Inputs: role "run" (run summary JSON), "dataset", "metrics", "fit_error", "evidence" and "fit" of the clips to draw
/// -> one self-contained HTML page.
Expected<StageOutcome> ReportStage(const StageRequest& request);

}  // namespace mocurate
