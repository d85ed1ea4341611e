#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/rig_common_faults.h"
#include "fitting/clouds/rig_exchange.h"
#include "fitting/clouds/rig_far_views.h"
#include "fitting/clouds/rig_units.h"

namespace mocurate {

/// Faults of depth cameras with code, camera, value and words. How sure they are (but of exchanged files), and whether
/// they are corrected, the audit says.
RigFault ExchangedFiles(const std::vector<std::string>& cameras, const FileExchange& exchange);
/// `off_ms` later by the clock of the others; `frames` is how many images later the nearest one is.
RigFault DepthClockOff(const std::string& camera, double off_ms, int frames);
RigFault DepthsOff(const std::string& camera, const WrongDepths& wrong);
/// Which is corrected, and sure: nothing else makes a person of them.
RigFault LengthsMisread(const MisreadLengths& misread);
/// Of all cameras of a rig.
RigFault FaultOfAll(const std::vector<std::string>& cameras, const CommonFault& common, const ObservedRig& rig);
/// `centre`: where the person is.
RigFault CameraMoved(const Camera& was, const Camera& is, const Vector3d& centre);

}  // namespace mocurate
