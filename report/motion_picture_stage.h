#pragma once

#include "core/pipeline/stage.h"
#include "report/motion_rows.h"

namespace mocurate {

/// The rows of the stages `draw` and `draw_video` from their inputs. Errors of reading them, and of ChooseMotionRows.
Expected<std::vector<MotionRow>> ReadRows(const StageRequest& request, const MotionPictureOptions& options);

/// Names of the sets without a row.
std::vector<std::string> SourcesWithout(const StageRequest& request, const std::vector<MotionRow>& rows);

}  // namespace mocurate
