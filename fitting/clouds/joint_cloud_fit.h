#pragma once

#include <string>
#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/costs/pose_state.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Joint tracks and depth views of one clip in one problem per frame. `tracks` is the fit of the tracks alone, with its
/// uncertainty: the pose starts there, and each of its joints is an observation with its own covariance. The shape is
/// first fitted to the clouds (one per frame) in the tracks' poses, so that what the body is not counts once and not in
/// every frame; how far the clouds are to be trusted is measured by how far poses from the clouds alone lie from the
/// tracks', beyond what the tracks are uncertain. Frames with few points, or joints that they do not reach, stay with
/// the tracks. Motion, uncertainty and residuals (of points) are those of the mix; states are those of the tracks, and
/// so are rotations of joints that move no capsule; findings are those of the tracks and "frames_without_evidence".
/// Error kInconsistent for clouds of another number of frames, or of which none has enough points, for tracks without
/// uncertainty, or a cloud that lies elsewhere than the tracks.
/// `alone`: poses of the clouds alone on the same skeleton and bones: a second start of every frame, for tracks that
/// may be far off.
Expected<FitResult> FitTracksAndClouds(const FitResult& tracks, const std::vector<FusedCloud>& clouds,
                                       const PointCloudOptions& options, const PoseState* alone = nullptr);

/// Frames that have points enough for a fit, at most 24, evenly spread.
std::vector<int> ShownFrames(const std::vector<FusedCloud>& clouds);

/// The motion's pose, up to date; joints that move no capsule of the body keep the rotation that it gives them.
PoseState StateOf(const Motion& motion, const CapsuleBody& body);

/// Error kInconsistent where a depth image is taken more than half a step from its frame of the tracks; names the
/// largest distance. Frames are compared up to the shorter of both.
Status CheckOneClock(const std::vector<double>& track_s, const std::vector<double>& depth_s, double step_s,
                     const std::string& clip);

}  // namespace mocurate
