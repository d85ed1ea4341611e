#pragma once

#include "core/motion/motion.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// Ground contact as a prior: where `pose`, the current fit of all frames, has an ankle or toe in contact, its process
/// noise is at most `options.contact_process_noise` (which must be set). The prior states that such a foot hardly
/// moves, not where the floor is. Skeletons without legs are not changed.
void HoldStandingFeet(const Motion& pose, const TrackWindow& window, ProcessNoiseScale& factors);

}  // namespace mocurate
