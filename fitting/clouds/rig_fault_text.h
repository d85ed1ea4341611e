#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/rig_common_faults.h"
#include "fitting/clouds/rig_exchange.h"
#include "fitting/clouds/rig_far_views.h"

namespace mocurate {

/// Faults of depth cameras with code, camera, value and message. The audit sets correction and confidence (except for
/// exchanged files).
RigFault ExchangedFiles(const std::vector<std::string>& cameras, const FileExchange& exchange);
/// `off_ms`: clock offset relative to the others; `frames`: offset of the nearest image.
RigFault DepthClockOff(const std::string& camera, double off_ms, int frames);
RigFault DepthsOff(const std::string& camera, const WrongDepths& wrong);
/// Always corrected and certain: no other unit gives a person.
RigFault LengthsMisread(const MisreadLengths& misread);
/// A fault of all cameras of a rig.
RigFault FaultOfAll(const std::vector<std::string>& cameras, const CommonFault& common, const ObservedRig& rig);
/// `centre`: of the person.
RigFault CameraMoved(const Camera& was, const Camera& is, const Vector3d& centre);

}  // namespace mocurate
