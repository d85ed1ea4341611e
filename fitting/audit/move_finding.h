#pragma once

#include <string>
#include <vector>

#include "fitting/audit/camera_moves.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// Whether two cameras have one pose, to the last digit.
bool StandAlike(const Camera& a, const Camera& b);

/// Views whose cameras stand elsewhere in `model` than in `given`.
std::vector<std::size_t> MovedViews(const RigModel& given, const RigModel& model);

/// Whether a move goes farther than the cameras of the rig stand from each other.
bool GoesTooFar(const RigModel& given, const CameraMove& move);

/// Whether a camera's place in some part shifts what it sees by more than detections err, and than a camera matters.
bool IsNotableMove(const Camera& was, const std::vector<CameraPart>& parts, const TriangulatedTracks& points,
                   double noise_px);

/// How far people are from where another model of the rig has them: mean outer product of the differences of the points
/// of all moments (m^2), gross ones excluded.
Matrix3d ShiftBetween(const RigSamples& samples, const RigModel& one, const RigModel& other,
                      const TriangulationOptions& options);

/// "views_disagree" of these views, with their names as a message to be continued.
RigFault DisagreementOf(const std::vector<RigView>& rig, std::vector<std::size_t> views);

}  // namespace mocurate
