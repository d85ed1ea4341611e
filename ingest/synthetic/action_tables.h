#pragma once

#include <vector>

#include "ingest/synthetic/actions.h"

namespace mocurate {

/// One action: a function that moves a pose, and its timing.
struct ActionRow {
  const char* name;
  void (*perform)(double at, const Manner& manner, Pose& pose);
  double period_s;  ///< of one cycle; 0: performed once
  double once_s;    ///< seconds to reach the pose and return
};

/// Warming up, lifting, boxing, running, jumping.
const std::vector<ActionRow>& ExerciseActions();
/// Drinking, eating, telephoning, driving, throwing, greeting, picking up.
const std::vector<ActionRow>& EverydayActions();

}  // namespace mocurate
