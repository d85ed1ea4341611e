#pragma once

#include <optional>
#include <string>

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

}  // namespace mocurate
