#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Code of the finding of a fit whose keypoints are of one camera; value: median distance in px of its keypoints.
inline constexpr const char* kOneKeypointView = "one_keypoint_view";

/// Depth views, and the keypoints of the one camera `view` as rays (RaysOf): FitClouds on `body`, the skeleton with the
/// detector's points, then every frame again with the rays beside its points. What the depth views alone tell of the
/// facing is doubted where left and right keypoints lie the other way round: then it is fitted from the opposite
/// facing. The motion has the skeleton's own joints. Clocks and places of the camera against the others are not
/// audited. A camera that sees the person in too few frames is left out: the finding says so. Errors of FitClouds.
Expected<FitResult> FitCloudsAndRays(const Clip& clip, const KeypointView& view, const SkeletonPtr& skeleton,
                                     const SkeletonPtr& body, const std::vector<double>& bone_length,
                                     const FittingOptions& options);

/// The skeleton with points of no flesh: joints from `skeleton`'s count on.
SkeletonPtr WithBarePoints(const SkeletonPtr& body, const SkeletonPtr& skeleton);

}  // namespace mocurate
