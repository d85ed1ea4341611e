#pragma once

#include <optional>
#include <string>

#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_samples.h"

namespace mocurate {

/// Faults of cameras with code, camera, frames, value and words. How sure they are, and whether they are corrected, the
/// audit says.

/// `later_s`: what the camera stamps happens so much later by the clock of the others; standard deviation, if known;
/// `worse`: share of the cost that is more without it.
RigFault ClockOff(const std::string& camera, double later_s, std::optional<double> sigma_s, double worse);

/// A camera that lists left as right in all frames of a take; by how much likelier it is, as a difference of log
/// likelihoods.
RigFault SidesExchanged(const std::string& camera, int frames, double margin);

/// A camera that does not stand as calibrated, in frames [begin, end) of a take of `frames`.
RigFault CameraMoved(const Camera& was, const Camera& is, int begin, int end, int frames);

}  // namespace mocurate
