#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Codes of findings about the two modalities.
inline constexpr const char* kModalityMissing = "evidence_kind_missing";  ///< value: frames of the other modality
inline constexpr const char* kModalitiesApart = "modalities_apart";       ///< value: mm
inline constexpr const char* kModalitiesClock = "modalities_clock_off";   ///< value: ms

/// Fits keypoints and depth views of one clip in one problem per frame: FitKeypointsOnBody, then FitTracksAndClouds
/// with its joints and the detector's points, each with the precision of the views. Both rigs are audited alone, and
/// then against each other (AlignModalities). A displacement or clock offset of the depth cameras as a whole is
/// reported, and corrected where options.point_clouds.audit allows it. A frame uses the nearest depth images, and keeps
/// the keypoints' pose without any within half a step. Where only one modality shows a person, the clip is fitted to
/// it, with a finding. `body` and `bone_length` as for FitKeypointsOnBody; the motion has the skeleton's own joints.
/// Errors of both fits; kInconsistent, with distance and size ratio, for modalities that do not show one person.
Expected<FitResult> FitKeypointsAndClouds(const Clip& clip, const SkeletonPtr& skeleton, const SkeletonPtr& body,
                                          const std::vector<double>& bone_length, const FittingOptions& options);

}  // namespace mocurate
