#pragma once

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "core/pipeline/stage.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"
#include "fitting/repair/track_repairs.h"

namespace mocurate {

/// Gives samples that were exchanged the state repaired, and adds the repairs to findings and the result's
/// track_repairs.
void ReportRepairs(const RepairedTracks& repaired, FitResult& fit);

/// Repairs the tracks (RepairTracks) and fits them (FitJointTracks). Exchanged samples get state repaired;
/// findings and the result's track_repairs list the repairs.
Expected<FitResult> RepairAndFit(const SkeletonTracks& given, const FrameRate& rate,
                                 const std::vector<double>& bone_length, const RepairOptions& repair,
                                 const JointTrackOptions& options);

/// Fit of a clip's joint tracks, or of the joints of its given motion, with given bones (J; empty: rest lengths).
/// `place_sigma`: of markers that were learnt (PersonBody). Errors of TracksOfClip, CheckSize (of given bones) and
/// FitJointTracks.
Expected<FitResult> FitTracksOfClip(const Clip& clip, const SkeletonPtr& skeleton,
                                    const std::vector<double>& bone_length, const FittingOptions& options,
                                    const std::vector<double>& place_sigma = {});

/// Fit of the person of a clip's keypoint views. `body` is the skeleton with the detector's points
/// (WithDetectorPoints), `bone_length` of the body (empty: measured on this clip); the motion has the skeleton's own
/// joints. Errors of TriangulateKeypoints, MapTracks and FitJointTracks; kInconsistent for a clip without keypoints.
Expected<FitResult> FitKeypointsOfClip(const Clip& clip, const SkeletonPtr& skeleton, const SkeletonPtr& body,
                                       const std::vector<double>& bone_length, const FittingOptions& options);

/// Replaces the names of the evidence's depth images by where those of the request lie (inputs of role "depth").
void ResolveDepthFiles(const StageRequest& request, Evidence& evidence);

/// Passes the motion of a clip through as a result. Error kInconsistent without one.
Expected<FitResult> TakeGivenMotion(const Clip& clip);

/// Error kInconsistent, with numbers, where the median joint is 0.3 m or a quarter of the stature from its evidence.
Status CheckExplained(const FitResult& fit, const std::string& where);

/// Outcome of the stage for a fit: the summary of fitting/stages.h and findings with the clip's id. Suspect when the
/// solver did not converge, the residual is large or a finding is an error. `clip` still has its evidence.
StageOutcome OutcomeOfFit(const Clip& clip, const FitResult& fit, const FittingOptions& options);

}  // namespace mocurate
