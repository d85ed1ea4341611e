#pragma once

#include <vector>

#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// Keypoint views as they should have been given: mirrored ones, ones of images of another size and ones that lie in
/// each other's files (FindMisreadViews, FindExchangedViews), put right where `options.audit.exchanged` says so and it
/// is sure. Each is a fault.
void MendFiles(Evidence& evidence, const std::vector<KnownLength>& lengths, const KeypointFitOptions& options,
               std::vector<RigFault>& faults);

}  // namespace mocurate
