#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Fits a capsule body to the depth views or cloud files of a clip, frame after frame: the rig is audited
/// (AuditDepthRig), the views are back-projected into the world, fused, thinned and freed of outliers, then matched to
/// the capsules of `skeleton` with bones of `bone_length` (J, metres; empty: rest lengths). The result's motion is in
/// the clip's world at the rate of the clip. Errors: kInconsistent without either or with views of unequal length;
/// kUnreadable, kMalformed for images.
Expected<FitResult> FitClouds(const Clip& clip, const SkeletonPtr& skeleton, const std::vector<double>& bone_length,
                              const PointCloudOptions& options);

/// Adds what an audit of the rig found: findings, the result's rig_audit and depth_rig.
void ReportRig(DepthRigReport report, FitResult& fit);

/// When the clouds of a clip were seen.
struct CloudClock {
  FrameRate rate;
  std::vector<double> time_s;  ///< (F) increasing
};

/// FitClouds of clouds that are fused already, one per frame, freed of what is not of the person.
Expected<FitResult> FitFusedClouds(std::vector<FusedCloud> clouds, const CloudClock& clock, const SkeletonPtr& skeleton,
                                   const std::vector<double>& bone_length, const PointCloudOptions& options);

}  // namespace mocurate
