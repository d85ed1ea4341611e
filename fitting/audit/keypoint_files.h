#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_hypotheses.h"
#include "fitting/options.h"

namespace mocurate {

/// Hypotheses about wrong files, in the order in which they were found.
struct FileFindings {
  std::vector<RigHypotheses> applied;   ///< the first hypothesis of each
  std::vector<RigHypotheses> reported;  ///< left as given
};

/// Corrects the keypoint views by FindRigHypotheses: exchanged files, mirrored images, images of another size, left and
/// right exchanged in one view. Corrects where `options.audit.exchanged` (for sides: `options.audit.sides`) allows it
/// and the confidence suffices; each is a fault. Error kInconsistent when files are certainly wrong and to be
/// corrected, but several hypotheses explain them equally well. Also where cameras in one place have different views
/// (FaultsOfSharedPlaces).
/// `found` receives the hypotheses.
Status CorrectFileAssignment(Evidence& evidence, const std::vector<KnownLength>& lengths,
                             const KeypointFitOptions& options, std::vector<RigFault>& faults, FileFindings& found);

/// Whether files are known (with confidence `audit.sure`) to be wrong and were not corrected. Clocks, poses and sides
/// cannot be estimated from them.
bool FilesAreExchanged(const std::vector<RigFault>& faults);

/// Whether exchanged or mirrored files were corrected, which may change left and right.
bool FilesAreCorrected(const std::vector<RigFault>& faults);

}  // namespace mocurate
