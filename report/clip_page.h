#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "report/filmstrip.h"
#include "report/options.h"

namespace mocurate {

/// What a page about one clip is made from.
struct ClipPageInput {
  DrawnClip clip;                 ///< with a fitted motion
  std::vector<Finding> findings;  ///< of ingest and fit, stored with the fit
  ClipPageOptions options;
};

/// One clip before and after its fit: video, filmstrips, player, residual beside jerk, bone lengths, repairs, states,
/// uncertainty, and the body over every view. Self-contained but for the video beside it. Error kInconsistent without a
/// motion.
Expected<std::string> MakeClipPage(const ClipPageInput& input);

}  // namespace mocurate
