#pragma once

#include <optional>

#include "core/quality/body_path.h"

namespace mocurate {

/// Steps as an inverted pendulum: while one foot bears the body, the centre of mass at height h and horizontal distance
/// d from it is accelerated by g d / h (Winter 1995, Hof 2005). Walking thus gives g in the declared time scale.
struct StepPendulum {
  int steps = 0;
  int stance = 0;            ///< frames, median
  double correlation = 0.0;  ///< between accelerations and d / h
  double lean = 0.0;         ///< root mean square of d / h
  double gravity = 0.0;      ///< metres per frame^2
};

/// Stances: one foot is in contact (at a third of the other's speed, and 0.7 of the centre's), is the lower one, and
/// the body is upright over it. Empty with fewer than four of them. Times wrong by a factor n give n^2 times g with the
/// same correlation. Low correlation means that the model does not hold (slow, leaning, hand-made motion).
std::optional<StepPendulum> MeasureStepPendulum(const BodyPath& body);

}  // namespace mocurate
