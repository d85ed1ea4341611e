#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// A person's triangulated keypoints on a body, and findings.
struct BodyTracks {
  SkeletonTracks tracks;
  KeypointReport report;
  std::vector<Finding> findings;  ///< clip id left empty
  std::vector<bool> exchanged;    ///< (F*J) or empty: samples that all views label as the other side
};

/// TriangulateKeypoints and MapTracks; keypoints that the body does not have are excluded. Where all views label left
/// what anatomy has on the right (FindBodyExchanges), the sides are exchanged back as `audit.sides` says (fault
/// "views_swap_sides"). Errors of both.
Expected<BodyTracks> TracksOnBody(const Evidence& evidence, const Skeleton& skeleton, const SkeletonPtr& body,
                                  const KeypointFitOptions& options);

/// Motion of the person in keypoint views: TriangulateKeypoints, then FitJointTracks on `body`, which is `skeleton`
/// with the detector's points (WithDetectorPoints): the motion has them too. `bone_length` of the body, metres; empty:
/// measured on this take. Errors of both.
Expected<FitResult> FitKeypointsOnBody(const Evidence& evidence, const FrameRate& rate, const SkeletonPtr& skeleton,
                                       const SkeletonPtr& body, const std::vector<double>& bone_length,
                                       const FittingOptions& options);

/// The same; the motion has the skeleton's own joints.
Expected<FitResult> FitKeypoints(const Evidence& evidence, const FrameRate& rate, const SkeletonPtr& skeleton,
                                 const SkeletonPtr& body, const std::vector<double>& bone_length,
                                 const FittingOptions& options);

}  // namespace mocurate
