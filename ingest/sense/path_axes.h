#pragma once

#include <optional>
#include <string>

#include "core/motion/motion.h"
#include "core/quality/handedness.h"

namespace mocurate {

/// Axes in which the path of a root fits the body that it carries, where it does not as it is written.
struct PathAxes {
  double share = 0.0;  ///< of the way that tells, on which a foot stands in those axes
  std::string words;   ///< "+x +z +y": where x, y and z of the body stand in the path; empty: as it is written
};

/// By the same steps, of the same motions as MeasureRootScale: in the right axes the root moves against a standing foot
/// as the body says. Steps that are alike in both axes say nothing. Nothing where no foot is known.
std::optional<PathAxes> MeasurePathAxes(const JointPositions& places, const HandednessPoints& body);

}  // namespace mocurate
