#pragma once

#include <optional>
#include <vector>

#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

/// A camera that does not stand where the model has it.
struct CameraMove {
  std::size_t view = 0;
  std::vector<CameraPart> camera;   ///< as it stands; two where it was moved during the take
  RigModel model;                   ///< with the camera where it stands
  std::vector<double> cost;         ///< of the moments (CostOfMoments), with it there
  std::vector<std::size_t> rivals;  ///< other views that, moved instead, explain the moments about as well
  double sure_of_camera = 1.0;      ///< confidence that it explains more than any other camera's move
};

/// The camera whose detections the others' points best explain by another pose: of all the take, or from a moment on,
/// where the medians of its pixel errors jump. Each part is refitted (RefitCamera) or stays as it was where that says
/// no more. Empty for fewer than four cameras, of which three are ambiguous, for more than twelve,
/// where the others outvote it, and where nothing gets much better.
std::optional<CameraMove> FindMove(const RigSamples& samples, const RigModel& model,
                                   const TriangulationOptions& options);

/// The same of one view alone; without rivals.
std::optional<CameraMove> FindMoveOf(const RigSamples& samples, const RigModel& model, std::size_t view,
                                     const TriangulationOptions& options);

/// Confidence from which on another explanation is no rival.
inline constexpr double kRivalBeaten = 0.9;

/// That the costs of moments are worse than others for sure, in some part of a camera that was moved (one, or two): of
/// the moments of that part at which they differ.
double ConfidenceOfMove(const RigSamples& samples, const std::vector<CameraPart>& parts,
                        const std::vector<double>& worse, const std::vector<double>& better);

/// And in one part.
double ConfidenceOfPart(const RigSamples& samples, const std::vector<CameraPart>& parts, std::size_t part,
                        const std::vector<double>& worse, const std::vector<double>& better);

/// How far a camera's new place takes what it sees at the person: medians over the points.
struct ObservedMove {
  double px = 0.0;
  double m = 0.0;  ///< at the depth of the points
};
ObservedMove MoveAtPoints(const Camera& was, const Camera& is, const TriangulatedTracks& points);

/// The parts of a moved camera refitted to all `frames`, from where the model has them; a part stays as it is where
/// that says nothing.
void RefitParts(const RigSamples& frames, std::size_t view, const TriangulationOptions& options, RigModel& model);

/// The moment from which on the second part of a moved camera holds, to the frame: `frames` are samples between the
/// moments that FindMove saw.
double WhenMoved(const RigSamples& frames, const RigModel& model, std::size_t view,
                 const TriangulationOptions& options);

}  // namespace mocurate
