#pragma once

#include "core/motion/motion.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// Ground contact as a prior: where `pose`, the fit so far of all frames of the window, has an ankle or toe that stands
/// on the floor, its walk is at most `options.contact_walk` (which must be set). It says that a foot which stands
/// hardly moves, not where the floor is; evidence of more than the walk's weight still moves it. Skeletons without legs
/// are left as they are.
void HoldStandingFeet(const Motion& pose, const TrackWindow& window, WalkFactors& factors);

}  // namespace mocurate
