#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Codes of findings about the two kinds of cameras.
inline constexpr const char* kKindMissing = "evidence_kind_missing";  ///< value: frames of the other kind
inline constexpr const char* kKindsApart = "kinds_apart";             ///< value: mm
inline constexpr const char* kKindsClock = "kinds_clock_off";         ///< value: ms

/// Keypoints and depth views of one clip in one problem per frame: FitKeypointsOnBody, then FitTracksAndClouds with its
/// joints and the detector's points, each as sure along every direction as the views make it. Both rigs are audited
/// alone, and then against each other (AlignKinds): where the depth cameras as a whole stand elsewhere or run late,
/// that is told, and corrected where options.point_clouds.audit says so. A frame takes the depth images nearest to it,
/// and keeps the keypoints' pose where there are none within half a step. Where only one kind shows anybody the clip is
/// fitted to that one and a finding says so. `body` and `bone_length` as for FitKeypointsOnBody; the motion has the
/// skeleton's own joints. Errors of both fits; kInconsistent for kinds that show no one person, with how far apart they
/// are and how large.
Expected<FitResult> FitKeypointsAndClouds(const Clip& clip, const SkeletonPtr& skeleton, const SkeletonPtr& body,
                                          const std::vector<double>& bone_length, const FittingOptions& options);

}  // namespace mocurate
