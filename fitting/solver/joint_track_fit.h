#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"

namespace mocurate {

/// Skeleton motion that explains joint tracks: minimises
///   1/2 [ sum Huber(|c (p - observed) / sigma|^2) + sum |Log(R_f^T R_f+1)|^2 / (q_r^2 dt)
///         + sum |p_f+1 - p_f|^2 / (q_p^2 dt) + sum Huber(|c Log(observed^T G) / sigma|^2) over recorded rotations
///         + sum |w|^2 / rest_sigma^2 + joint limits ]
/// over root translation and one rotation vector per joint and frame, from the closed-form start (Levenberg-Marquardt,
/// sparse Cholesky, one thread). Process noises q_r, q_p are increased where the noise is not white
/// (ProcessNoiseWidening), and refitted per joint and time by steps that request it (RefitProcessNoise). F frames of
/// `given` at `rate`; `bone_length` (J, metres). Joints whose rotation moves no observed joint stay in the rest pose.
/// Samples that jump away and back are rejected first (RejectOutliers). States: observed where observed and not
/// rejected, else by GapStates with max_gap_s. Error kInconsistent if the solver fails.
Expected<FitResult> FitJointTracks(const SkeletonTracks& given, const FrameRate& rate,
                                   const std::vector<double>& bone_length, const JointTrackOptions& options);

}  // namespace mocurate
