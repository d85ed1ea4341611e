#pragma once

#include <optional>
#include <vector>

#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

/// A camera that does not stand where the model has it.
struct CameraMove {
  std::size_t view = 0;
  std::vector<CameraPart> camera;  ///< as it stands; two where it was moved during the take
  RigModel model;                  ///< with the camera where it stands
};

/// The camera whose detections the others' points best explain by another pose: of all the take, or from a moment on,
/// where the medians of its pixel errors jump. Each part is refitted (RefitCamera) or stays as it was where that says
/// no more. Empty for fewer than four cameras, of which three could not be told from each other, for more than twelve,
/// where the others outvote it, and where nothing gets much better.
std::optional<CameraMove> FindMove(const RigSamples& samples, const RigModel& model,
                                   const TriangulationOptions& options);

/// The parts of a moved camera refitted to all `frames`, from where the model has them; a part stays as it is where
/// that says nothing.
void RefitParts(const RigSamples& frames, std::size_t view, const TriangulationOptions& options, RigModel& model);

/// The moment from which on the second part of a moved camera holds, to the frame: `frames` are samples between the
/// moments that FindMove saw.
double WhenMoved(const RigSamples& frames, const RigModel& model, std::size_t view,
                 const TriangulationOptions& options);

}  // namespace mocurate
