#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

/// A camera whose pose differs from the model's.
struct CameraMove {
  std::size_t view = 0;
  std::vector<CameraPart> camera;   ///< refitted; two parts where it was moved during the take
  RigModel model;                   ///< with the refitted camera
  std::vector<double> cost;         ///< of the moments (CostOfMoments), with the refitted camera
  std::vector<double> held_out;     ///< likewise, each half with the camera refitted to the other half (HeldOutCosts)
  std::vector<std::size_t> rivals;  ///< other views whose move explains the moments about as well
  double confidence = 1.0;          ///< confidence that this move explains more than any other camera's (held_out)
};

/// The camera whose detections another pose best explains, given the points of the other views. The pose holds for the
/// whole take, or from the moment on at which the medians of its pixel errors jump. Each part is refitted
/// (RefitCamera), or keeps its pose where that returns none. Empty for fewer than four cameras (of three the moved one
/// is ambiguous) and for more than twelve (the others outvote it). Empty without a clear improvement. Held-out costs
/// choose the camera.
std::optional<CameraMove> FindMove(const RigSamples& samples, const RigModel& model,
                                   const TriangulationOptions& options);

/// FindMove for one view, without rivals; from three cameras on.
std::optional<CameraMove> FindMoveOf(const RigSamples& samples, const RigModel& model, std::size_t view,
                                     const TriangulationOptions& options);

/// Confidence from which another explanation is not a rival.
inline constexpr double kRivalBeaten = 0.9;

/// Costs of the moments, those of each half with the moves of the views that FindMoveOf finds in the other half.
std::vector<double> HeldOutCostsOfMoves(const RigSamples& samples, const RigModel& model,
                                        const std::vector<std::size_t>& views, const TriangulationOptions& options);

/// Confidence that the held-out costs of moments are lower, the highest over the parts (one, or two) of a moved camera.
/// Each part counts its moments with a different cost. It is 0 where one half of the take (HalvesOf) has none: nothing
/// was fitted to the other half.
double ConfidenceOfMove(const RigSamples& samples, const std::vector<CameraPart>& parts,
                        const std::vector<double>& worse, const std::vector<double>& better);

/// Displacement that a camera's new pose causes at the person: medians over the points.
struct ObservedMove {
  double px = 0.0;
  double m = 0.0;  ///< at the depth of the points
};
ObservedMove MoveAtPoints(const Camera& was, const Camera& is, const TriangulatedTracks& points);

/// Refits the parts of a moved camera to all `frames`, starting from the model. A part keeps its pose where RefitCamera
/// returns none.
void RefitParts(const RigSamples& frames, std::size_t view, const TriangulationOptions& options, RigModel& model);

/// The exact frame time at which the second part of a moved camera begins. `frames`: samples between the moments of
/// FindMove.
double WhenMoved(const RigSamples& frames, const RigModel& model, std::size_t view,
                 const TriangulationOptions& options);

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
