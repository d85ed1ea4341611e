#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/solver/track_problem.h"

namespace mocurate {

/// Refits the process noise per joint and time: the squared steps of the solved fit over those expected from the
/// present process noise. A fit shows the share of a process noise's variance that the evidence determined: the prior
/// variance of a step (from all process noises together, which share the motion of the whole body) minus the posterior
/// one (MacKay 1992, evidence maximisation, one step). Both are summed over the joint's steps nearby in time and shrunk
/// towards the joint's mean over the clip, and that towards all joints' mean. Steps across gaps keep their factor.
/// `window` is the whole clip at its solution, with the factors it was solved with. Error kInconsistent if the matrix
/// cannot be factored.
Expected<ProcessNoiseScale> RefitProcessNoise(const TrackProblem& window);

}  // namespace mocurate
