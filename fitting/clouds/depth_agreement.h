#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"

namespace mocurate {

/// How well the depth views of one moment agree: for every view the root mean square distance (m) of its points to the
/// nearest point of any other view, each at most `farthest`. Looks at every `every`-th point; needs views that see the
/// same surfaces, so many or near each other. Errors of BackProject; kInconsistent for fewer than two views with
/// points.
Expected<std::vector<double>> ViewAgreement(const std::vector<DepthView>& views, int frame, double farthest, int every);

}  // namespace mocurate
