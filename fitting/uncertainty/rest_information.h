#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

/// (J) typical rotation of each joint from the rest pose, radians per axis: RestPoseSigmas of 1 rad.
std::vector<double> TypicalRotations(const Skeleton& skeleton);

/// Prior information of each joint in each frame, 1/rad^2 per axis (F*J), from its typical rotation s. It must not
/// count again in every frame, as posture persists. Process noise (q = RotationVariance of a step) and rest pose form
/// one stationary process with standard deviation s (Ornstein-Uhlenbeck: correlation time 2 s^2 / q steps). Each step
/// gives its two frames tanh(q / (4 s^2)) / (2 s^2), and the first and last frame between gaps have 1 / (2 s^2) in
/// addition. For fast joints, the correlation time is at least 5 s. A single frame has 1 / s^2. The fit's own rest
/// prior is another one, weak enough to count in every frame.
std::vector<double> RestInformationOfProcessNoise(const TrackWindow& whole);

}  // namespace mocurate
