#pragma once

#include <string>
#include <vector>

#include "fitting/audit/camera_moves.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// Whether two cameras have exactly the same pose.
bool HaveSamePose(const Camera& a, const Camera& b);

/// Views whose cameras have another pose in `model` than in `given`.
std::vector<std::size_t> MovedViews(const RigModel& given, const RigModel& model);

/// Whether a move is longer than the largest distance between cameras of the rig.
bool GoesTooFar(const RigModel& given, const CameraMove& move);

/// Whether a camera's pose in some part shifts its points by more than detection noise and by a relevant distance.
bool IsNotableMove(const Camera& was, const std::vector<CameraPart>& parts, const TriangulatedTracks& points,
                   double noise_px);

/// Difference of people's positions between two models of the rig: mean outer product of the differences over the
/// points of all moments (m^2), without outliers.
Matrix3d ShiftBetween(const RigSamples& samples, const RigModel& one, const RigModel& other,
                      const TriangulationOptions& options);

/// "views_disagree" of these views, with the start of a message that names them.
RigFault DisagreementOf(const std::vector<RigView>& rig, std::vector<std::size_t> views);

}  // namespace mocurate
