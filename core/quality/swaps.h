#pragma once

#include <array>
#include <string_view>

#include "core/quality/tracked_points.h"

namespace mocurate {

struct SwapLimits {
  double ratio = 0.35;  ///< of squared steps with the sides exchanged to those without, below which they are exchanged
  double step = 0.1;    ///< metres, root mean square of the limbs' steps in the frame; smaller ones say nothing
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

/// Sides that swap: arms or legs that within one frame jump to where those of the other side were, which costs a
/// tracker nothing and a person a somersault. A change that no single step shows, because limbs are not seen or stray
/// in it, is found where the limbs lie within `gap_s` of another as before it (or lay as after it). Between two such
/// frames the sides are exchanged; the state that lasts longer in the clip is right, so that
/// a clip that is wrong throughout is not found here (handedness tells). A step in which the body itself jumps says
/// nothing: frames are missing there, and half a stride later each foot is where the other was. "swapped_sides": the
/// span in the rarer state; value: the smallest ratio of squared steps at its ends. Arms and legs of one span are one
/// finding; where the ones change sides, 0.6 is enough for the others.
std::vector<Finding> FindSwaps(const TrackedPoints& points, const SwapLimits& limits = {});

}  // namespace mocurate
