#pragma once

#include <vector>

#include "fitting/solver/track_window.h"

namespace mocurate {

/// (J) how far people turn each joint from the rest pose, radians per axis: RestSpreads of a usual turn of 1 rad.
std::vector<double> UsualTurns(const Skeleton& skeleton);

/// What is known of each joint in each frame before any evidence, 1/rad^2 per axis (F*J): its usual turn s. That is
/// known once, not again in every frame: who has an elbow bent now has it bent in the next frame too. The walk of a
/// joint (q = TurnVariance of a step) and the rest pose are taken as one stationary process, whose standard deviation
/// is s however slow the walk is (Ornstein-Uhlenbeck: correlation time 2 s^2 / q steps): each step ties its two frames
/// by tanh(q / (4 s^2)) / (2 s^2), and the first and last frame between gaps have 1 / (2 s^2) beside. Joints that move
/// fast do not tell more of where they are in the mean: a step ties by no more than with a correlation time of 5 s. A
/// single frame has 1 / s^2. The fit's own rest prior is another: so weak that it may be said in every frame.
std::vector<double> RestInformationOfWalks(const TrackWindow& whole);

}  // namespace mocurate
