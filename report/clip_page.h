#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "report/filmstrip.h"
#include "report/options.h"

namespace mocurate {

/// Input of a page about one clip.
struct ClipPageInput {
  DrawnClip clip;                 ///< with a fitted motion
  std::vector<Finding> findings;  ///< of ingest and fit, stored with the fit
  ClipPageOptions options;
};

/// One clip before and after its fit: video, filmstrips, player, residual and jerk, bone lengths, corrections, states,
/// uncertainty, and the body over every view. Self-contained except for the video beside it. Error kInconsistent
/// without a motion.
Expected<std::string> MakeClipPage(const ClipPageInput& input);

}  // namespace mocurate
