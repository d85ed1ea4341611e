#pragma once

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/pipeline/stage.h"
#include "report/filmstrip.h"

namespace mocurate {

/// A clip and its fit, read from the inputs "evidence", "fit" and "depth" of a stage that draws one clip; `findings`
/// receives those stored with the fit. Errors of ReadEvidence and ReadDataset, kInconsistent for a fit without a clip.
Expected<DrawnClip> ReadDrawnClip(const StageRequest& request, std::vector<Finding>* findings = nullptr);

}  // namespace mocurate
