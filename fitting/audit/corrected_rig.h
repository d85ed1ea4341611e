#pragma once

#include <vector>

#include "fitting/association/rig_view.h"
#include "fitting/audit/rig_samples.h"

namespace mocurate {

/// The views as the model has them: stamps by the others' clock, cameras where they stand, sides as the others call
/// them. A camera that was moved during the take is two views, the later one named "NAME from frame N" by `time_s`, the
/// frames of the take.
std::vector<RigView> CorrectedRig(const std::vector<RigView>& rig, const RigModel& model,
                                  const std::vector<std::size_t>& other_side, const std::vector<double>& time_s);

/// The first frame not before a moment.
int FrameAt(const std::vector<double>& time_s, double moment);

}  // namespace mocurate
