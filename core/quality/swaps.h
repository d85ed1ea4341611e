#pragma once

#include <array>
#include <string_view>

#include "core/quality/tracked_points.h"

namespace mocurate {

struct SwapLimits {
  double ratio = 0.35;  ///< of squared steps with the sides exchanged to those without, below which they are exchanged
  double step = 0.1;    ///< metres, root mean square of the limbs' steps in the frame; smaller ones are ignored
  double gap_s = 0.25;  ///< longest time without the limbs over which steps are taken
};

/// Pairs (left, right) of one kind of limb, by the names of the points: "left_knee" and "right_knee", "LeftKnee",
/// "knee_l", "Foot_L" ...
struct LimbPairs {
  std::vector<std::array<int, 2>> arms;  ///< shoulder, elbow, wrist, hand ...
  std::vector<std::array<int, 2>> legs;  ///< hip, knee, ankle, foot ...
  std::vector<std::array<int, 2>> face;  ///< eye, ear
};
LimbPairs FindLimbPairs(const std::vector<std::string>& names);

/// Left-right swaps: arms or legs that move within one frame to the positions of the other side. A change without a
/// single clear step, because limbs are missing or outliers there, is found where the limbs are within `gap_s` of
/// another change as before it (or were as after it). Between two changes the sides are exchanged. The state that lasts
/// longer in the clip is taken as right; a clip that is wrong throughout is found by handedness instead. A step in
/// which the whole body jumps is ignored: frames are missing there, and half a stride later each foot is where the
/// other was. "swapped_sides": the span in the rarer state; value: the smallest ratio of squared steps at its ends.
/// Arms and legs of one span are one finding; where one pair changes sides, a ratio of 0.6 is enough for the other.
std::vector<Finding> FindSwaps(const TrackedPoints& points, const SwapLimits& limits = {});

}  // namespace mocurate
