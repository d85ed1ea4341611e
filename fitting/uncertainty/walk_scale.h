#pragma once

#include "fitting/solver/track_window.h"

namespace mocurate {

/// How much more (or less) a person moves in a clip than the random walks of its options assume: the factor on the
/// walks that maximises the expected likelihood of the steps from frame to frame, of every rotation and of the root's
/// position, given the solved fit and its uncertainty (one step of expectation maximisation). `window` is the whole
/// clip at its solution. 1 for a clip without steps. Error kInternal if the matrix cannot be factored.
Expected<double> WalkScale(const TrackWindow& window);

}  // namespace mocurate
