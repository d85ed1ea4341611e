#pragma once

#include "core/base/error.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// How much more (or less) a person moves each joint, and when, than the random walks of the options assume: of every
/// step from frame to frame the square that is expected of it, given the solved fit and its uncertainty (one step of
/// expectation maximisation), averaged over the joint's steps nearby in time and drawn towards the joint's mean over
/// the clip, that towards the mean of all joints. Steps across gaps keep what they had. `window` is the whole clip at
/// its solution, with the factors it was solved with. Error kInternal if the matrix cannot be factored.
Expected<WalkFactors> RefitWalks(const TrackWindow& window);

}  // namespace mocurate
