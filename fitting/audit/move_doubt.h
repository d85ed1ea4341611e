#pragma once

#include <string>
#include <vector>

#include "fitting/audit/camera_moves.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {

/// Views whose cameras stand elsewhere in `model` than in `given`.
std::vector<std::size_t> MovedViews(const RigModel& given, const RigModel& model);

/// Whether a move goes farther than the cameras of the rig stand from each other.
bool GoesTooFar(const RigModel& given, const CameraMove& move);

/// "views_disagree" of these views, with their names as a message to be continued.
RigFault DisagreementOf(const std::vector<RigView>& rig, std::vector<std::size_t> views);

}  // namespace mocurate
