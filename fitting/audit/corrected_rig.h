#pragma once

#include <vector>

#include "fitting/association/rig_view.h"
#include "fitting/audit/rig_samples.h"

namespace mocurate {

/// The views with the model's clocks, camera poses and left-right assignments. A camera that was moved during the take
/// becomes two views. The later one is named "NAME from frame N", by `time_s`, the frames of the take.
std::vector<RigView> CorrectedRig(const std::vector<RigView>& rig, const RigModel& model,
                                  const std::vector<std::size_t>& other_side, const std::vector<double>& time_s);

/// The first frame at or after a moment.
int FrameAt(const std::vector<double>& time_s, double moment);

}  // namespace mocurate
