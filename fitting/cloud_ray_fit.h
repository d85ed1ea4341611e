#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Code of the finding of a fit whose keypoints are of one camera; value: median distance of its keypoints, px.
inline constexpr const char* kOneKeypointView = "one_keypoint_view";

/// Fits depth views and the keypoints of the one camera `view` as rays (RaysOf): FitClouds on `body`, the skeleton with
/// the detector's points, then every frame again with its rays. Where left and right keypoints contradict the facing
/// from the depth views, the fit starts again from the opposite facing. The motion has the skeleton's own joints. The
/// camera's clock and pose are not audited. A camera that sees the person in too few frames is excluded, with a
/// finding. Errors of FitClouds.
Expected<FitResult> FitCloudsAndRays(const Clip& clip, const KeypointView& view, const SkeletonPtr& skeleton,
                                     const SkeletonPtr& body, const std::vector<double>& bone_length,
                                     const FittingOptions& options);

/// The skeleton with the detector's points, which have no body shape: joints from `skeleton`'s count on.
SkeletonPtr WithBarePoints(const SkeletonPtr& body, const SkeletonPtr& skeleton);

}  // namespace mocurate
