#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/solver/track_problem.h"

namespace mocurate {

/// Refits the process noise per joint and time: the squared steps of the solved fit over those expected from the
/// present process noise. A fit shows the share of a process noise's variance that the evidence determined: the prior
/// variance of a step (from all process noises together, which share the motion of the whole body) minus the posterior
/// one (MacKay 1992, evidence maximisation, one step). Both are summed over the joint's steps nearby in time and shrunk
/// towards the joint's mean over the clip, and that towards all joints' mean. Steps across gaps keep their factor.
/// `window` is the whole clip at its solution, with the factors it was solved with. Error kInconsistent if the matrix
/// cannot be factored.
Expected<ProcessNoiseScale> RefitProcessNoise(const TrackProblem& window);

/// (J) typical rotation of each joint from the rest pose, radians per axis: RestPoseSigmas of 1 rad.
std::vector<double> TypicalRotations(const Skeleton& skeleton);

/// Prior information of each joint in each frame, 1/rad^2 per axis (F*J), from its typical rotation s. It must not
/// count again in every frame, as posture persists. Process noise (q = RotationVariance of a step) and rest pose form
/// one stationary process with standard deviation s (Ornstein-Uhlenbeck: correlation time 2 s^2 / q steps). Each step
/// gives its two frames tanh(q / (4 s^2)) / (2 s^2), and the first and last frame between gaps have 1 / (2 s^2) in
/// addition. For fast joints, the correlation time is at least 5 s. A single frame has 1 / s^2. The fit's own rest
/// prior is another one, weak enough to count in every frame.
std::vector<double> RestInformationOfProcessNoise(const TrackProblem& whole);

}  // namespace mocurate
