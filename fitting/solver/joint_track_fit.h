#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Skeleton motion that explains joint tracks: positions, recorded rotations, process noise of rotations and positions,
/// rest pose, limits and hinges (terms/terms.h), over root translation and one rotation vector per joint and frame,
/// from the closed-form start. Process noises q_r, q_p are increased where the noise is not white
/// (ProcessNoiseWidening), and refitted per joint and time by steps that request it (RefitProcessNoise). F frames of
/// `given` at `rate`; `bone_length` (J, metres). Joints whose rotation moves no observed joint stay in the rest pose.
/// Samples that jump away and back are rejected first (RejectOutliers). States: observed where observed, not rejected,
/// and at most 0.15 m or four of the sample's standard deviations from the fitted joint (kSamplesContradicted), else by
/// GapStates with max_gap_s. Error kInconsistent if the solver fails.
Expected<FitResult> FitJointTracks(const SkeletonTracks& given, const FrameRate& rate,
                                   const std::vector<double>& bone_length, const JointTrackOptions& options);

}  // namespace mocurate
