#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// A view with a clock offset.
struct ClockOffsetOfView {
  std::size_t view = 0;
  int frames = 0;           ///< its image this many frames later matches the other views
  double offset = 0.0;      ///< the offset in frames with a fraction, from a parabola through the losses
  double confidence = 0.0;  ///< that the offset is not 0
  double decrease = 0.0;    ///< of the losses of its comparisons, summed
};

/// The view whose agreement with the others improves most at another frame offset, if that is not 0 with confidence
/// `sure`. Offsets are at most `longest` frames from `delays`. First tries one frame to each side, whose images the
/// sampler has loaded, then continues in the direction of the lower loss. Views with a high loss are also tried farther
/// away. Of two views the second is corrected. Errors of ReadFrame.
Expected<std::optional<ClockOffsetOfView>> FindClockOffset(DepthRigSampler& sampler, const std::vector<int>& delays,
                                                           const std::vector<Camera>& cameras, int longest,
                                                           double sure);

/// The lowest loss of a view's comparisons within one frame to each side (a parabola): what a clock offset below one
/// frame explains.
Expected<double> LeastLossBetweenFrames(DepthRigSampler& sampler, const std::vector<int>& delays,
                                        const std::vector<Camera>& cameras, std::size_t view);

/// The view with images `frames` later; frames without an image get an empty file name.
DepthView DelayBy(const DepthView& view, int frames);

/// The fault; the audit sets confidence and correction. `off_ms`: clock offset relative to the others; `frames`: offset
/// of the nearest image.
RigFault DepthClockOff(const std::string& camera, double off_ms, int frames);

}  // namespace mocurate
