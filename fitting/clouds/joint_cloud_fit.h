#pragma once

#include <string>
#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {

/// Share of the points that must lie near a body with known poses; fewer show another person.
inline constexpr double kNearBodyShare = 0.5;

/// Fits joint tracks and depth views of one clip in one problem per frame. `tracks` is the fit of the tracks alone with
/// its uncertainty and pose covariances (JointTrackOptions::poses): the initial pose, and what is known of each frame
/// beside its points. The body shape is first fitted to all clouds (one per frame) in the tracks' poses, so that shape
/// errors count only once. The surface weight follows from the distance between poses of the clouds alone and the
/// tracks', beyond the tracks' uncertainty. Frames with few points, and joints that points do not reach, keep the
/// tracks' result. Motion, uncertainty and residuals (of points) are those of the combined fit. States, and rotations
/// of joints without capsules, are the tracks'. Findings are the tracks' and "frames_without_depth". Error
/// kInconsistent for another number of clouds than frames, without enough points, for tracks without uncertainty, and
/// for a cloud far from the tracks. Where the tracks are uncertain, or show nothing of a limb, the clouds are also
/// tracked alone, from the tracks' facing: a second start of every frame.
Expected<FitResult> FitTracksAndClouds(FitResult tracks, const std::vector<FusedCloud>& clouds,
                                       const PointCloudOptions& options);

/// Joints with an observation at or below them in any frame; samples that contradict the fitted body are none. The fit
/// of the tracks has no information about the others. (J)
std::vector<bool> KnownJoints(const Motion& motion);

/// Standard deviation per axis that a motion states, root mean square over the frames: of joints with keypoints, or of
/// all. Joints without keypoints do not matter for camera poses.
double StatedSigma(const Motion& motion, const std::vector<int>& frames, bool all);

/// At most 24 evenly spaced frames with enough points for a fit.
std::vector<int> ShownFrames(const std::vector<FusedCloud>& clouds);

/// The motion's pose, updated; joints without capsules keep the motion's rotation.
PoseState StateOf(const Motion& motion, const CapsuleBody& body);

/// Error kInconsistent when a depth image is more than half a step from its frame of the tracks, with the largest
/// distance. Compares frames up to the shorter length.
Status CheckOneClock(const std::vector<double>& track_s, const std::vector<double>& depth_s, double step_s,
                     const std::string& clip);

}  // namespace mocurate
