#pragma once

#include <optional>

#include "core/quality/body_path.h"

namespace mocurate {

/// Steps as a pendulum on its head: while one foot bears the body, the centre of mass at height h and horizontal
/// distance d from it is accelerated by g d / h (Winter 1995, Hof 2005). Who walks thus shows g, in time as marked.
struct StepPendulum {
  int steps = 0;
  int stance = 0;            ///< frames, median
  double correlation = 0.0;  ///< between accelerations and d / h
  double lean = 0.0;         ///< root mean square of d / h
  double gravity = 0.0;      ///< metres per frame^2
};

/// Stances: one foot stands (at a third of the other's speed, and of the centre's by 0.7), is the lower one, and the
/// body is upright over it. Nothing without four of them. Times that are wrong by n show n^2 times g with the same
/// correlation; where there is little, the motion is none of mechanics (slow, leaning, made by hand) and tells nothing.
std::optional<StepPendulum> MeasureStepPendulum(const BodyPath& body);

}  // namespace mocurate
