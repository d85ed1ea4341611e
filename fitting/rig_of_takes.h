#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"
#include "core/motion/skeleton.h"
#include "fitting/options.h"
#include "fitting/rig_file.h"

namespace mocurate {

/// The keypoints of one take of a rig.
struct TakeOfRig {
  std::string name;    ///< clip id
  std::string sha256;  ///< of its evidence
  Evidence evidence;
};

/// A rig audited with several takes together.
struct RigOfTakes {
  RigFile rig;                    ///< without the name of the configuration
  std::vector<Finding> findings;  ///< "takes_disagree", "take_not_audited", kRigNotAudited, and RigFaults
};

/// Audits the rig of takes that share cameras: their moments count together (AuditRig). Where takes disagree about a
/// camera, its verdict is ambiguous and a finding names it. With two takes and more a confidence is that of the mean
/// gain of takes being above zero, by the variation between them; with one take, that of the spans of the take. Errors
/// of TriangulateKeypoints for the takes together; kInconsistent for takes with other cameras, calibrations or
/// keypoints, and where no camera can be audited.
Expected<RigOfTakes> AuditTakes(const std::vector<TakeOfRig>& takes, const Skeleton& skeleton,
                                const KeypointFitOptions& options);

}  // namespace mocurate
