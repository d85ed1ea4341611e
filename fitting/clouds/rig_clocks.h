#pragma once

#include <optional>
#include <vector>

#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// A view whose images are of other moments than those of the others.
struct ClockOffsetOfView {
  std::size_t view = 0;
  int frames = 0;           ///< its image of so many frames later is what the others see now
  double offset = 0.0;      ///< frames, between whole ones: where a parabola through the losses is least
  double confidence = 0.0;  ///< that so it agrees better with the others
  double gain = 0.0;        ///< share of the loss of its comparisons
};

/// The view that agrees much better with the others (surely, by `sure`) at other frames, at most `longest` of them away
/// from where `late` has it: first one frame to each side, whose images the groups of the sampler hold already, then
/// farther the way that the loss falls. Views that disagree badly are also tried farther away at once. Of two views
/// the second is taken. Errors of ReadFrame.
Expected<std::optional<ClockOffsetOfView>> FindClockOffset(DepthRigSampler& sampler, const std::vector<int>& late,
                                                           const std::vector<Camera>& cameras, int longest,
                                                           double sure);

/// The least loss of a view's comparisons within one frame to each side (a parabola): what its clock may explain.
Expected<double> LeastLossBetweenFrames(DepthRigSampler& sampler, const std::vector<int>& late,
                                        const std::vector<Camera>& cameras, std::size_t view);

/// The view's images of so many frames later; frames of which it has none get an empty file name.
DepthView DelayBy(const DepthView& view, int frames);

}  // namespace mocurate
