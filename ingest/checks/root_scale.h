#pragma once

#include <optional>
#include <string>

#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "core/quality/handedness.h"

namespace mocurate {

/// By how much the path of a root would have to be multiplied to fit the body that it carries.
struct RootScale {
  double factor = 1.0;  ///< 0.01: the path is in centimetres where the body is in metres
  double sure = 0.0;    ///< share of the way that agrees, 0 to 1
  std::string evidence;
};

/// Of a motion whose bones and path come from different places: a standing foot stays where it is, so that the root
/// moves against it as the body says. Joint 0 is the root; any unit, any axes, upright from feet to head on the whole.
/// Where fewer than 20 moments show one, or they disagree, only feet that are 10 legs above zero tell; else nothing.
std::optional<RootScale> MeasureRootScale(const JointPositions& places, const BodyLandmarks& body);

/// "units_contradiction", an error whose value is the factor: bones of a file and the path of its root (joint 0) that
/// are of two units, as that path is at least 8 times too long or too short for the body's steps (MeasureRootScale).
std::optional<Finding> CheckRootPath(const JointPositions& places, const BodyLandmarks& body);

}  // namespace mocurate
