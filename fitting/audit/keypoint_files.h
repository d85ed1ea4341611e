#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// Keypoint views as they should have been given, by what FindRigHypotheses finds: ones that lie in each other's files,
/// mirrored ones, ones of images of another size, one that calls left right. Put right where `options.audit.exchanged`
/// (of sides: `options.audit.sides`) says so and it is sure; each is a fault. kInconsistent where it is sure that files
/// are not as given, they are to be corrected, and more than one reading explains as much,
/// and where cameras in one place see different things (FaultsOfSharedPlaces).
Status CorrectFileAssignment(Evidence& evidence, const std::vector<KnownLength>& lengths,
                             const KeypointFitOptions& options, std::vector<RigFault>& faults);

/// Whether files are known (to `audit.sure`) to be other than given, and were left so: clocks, places and sides cannot
/// be judged by them.
bool FilesAreExchanged(const std::vector<RigFault>& faults);

/// Whether files were exchanged or turned over: which side is which may follow from that.
bool FilesAreCorrected(const std::vector<RigFault>& faults);

}  // namespace mocurate
