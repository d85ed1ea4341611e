#pragma once

#include <optional>
#include <string>

#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_samples.h"

namespace mocurate {

/// Faults of cameras with code, camera, frames, value and message. The audit sets confidence and correction.

/// `later_s`: clock offset of the camera relative to the others, seconds; its standard deviation, if known; `worse`:
/// relative increase of the cost without the offset.
RigFault ClockOff(const std::string& camera, double later_s, std::optional<double> sigma_s, double worse);

/// A camera that lists left as right in all frames of a take. `margin`: log-likelihood ratio.
RigFault SidesExchanged(const std::string& camera, int frames, double margin);

/// A camera whose pose differs from that of `reference` ("its calibration"), in frames [begin, end) of a take of
/// `frames`.
RigFault CameraMoved(const Camera& was, const Camera& is, const std::string& reference, int begin, int end, int frames);

}  // namespace mocurate
