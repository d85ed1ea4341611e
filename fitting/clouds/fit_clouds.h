#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Fits a capsule body to the depth views or cloud files of a clip, frame after frame. Audits the rig (AuditDepthRig),
/// fuses the back-projected views in the world, thins them and drops outliers. Then it matches the points to the
/// capsules of `skeleton` with bones of `bone_length` (J, metres; empty: rest lengths). The motion is in the clip's
/// world at the clip's rate. Errors: kInconsistent without either evidence or for views of unequal length; kUnreadable,
/// kMalformed for images.
Expected<FitResult> FitClouds(const Clip& clip, const SkeletonPtr& skeleton, const std::vector<double>& bone_length,
                              const PointCloudOptions& options);

/// Adds the results of a rig audit to `fit`: findings, rig_audit and depth_rig.
void ReportRig(DepthRigReport report, FitResult& fit);

/// Times of a clip's clouds.
struct CloudClock {
  FrameRate rate;
  std::vector<double> time_s;  ///< (F) increasing
};

/// FitClouds for fused clouds of the person, one per frame.
Expected<FitResult> FitFusedClouds(std::vector<FusedCloud> clouds, const CloudClock& clock, const SkeletonPtr& skeleton,
                                   const std::vector<double>& bone_length, const PointCloudOptions& options);

}  // namespace mocurate
