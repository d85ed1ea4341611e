#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "ingest/synthetic/pose.h"

namespace mocurate {

/// How one repetition is performed.
struct Manner {
  double amplitude = 1.0;
  double phase = 0.0;     ///< radians, of oscillating movements
  double cycles = 2.0;    ///< of movements that repeat
  double active_s = 2.0;  ///< seconds from the first to the last movement
  bool seated = false;    ///< on a chair all the time
  double turn = 0.0;      ///< radians about +y over the action: walks in a circle
};

/// Names of the actions, sorted: simple ones (clap, jump, kick, ...), HumanAct12's 34 variants (humanact12_set.h) and
/// those of other sets.
std::vector<std::string> KnownActions();

/// Error kConfig for an unknown name, with the nearest known one.
Status CheckAction(const std::string& name);

/// Seconds of one cycle at an everyday tempo; 0 for actions performed once. Known actions only.
double NaturalPeriod(const std::string& action);

/// Seconds of the action with that many cycles.
double NaturalDuration(const std::string& action, double cycles);

/// Moves `pose` (standing) to its state at `progress` in [0, 1] of the action's time. One-handed actions that do not
/// name a side lead with the right. Known actions only.
void Perform(const std::string& action, double progress, const Manner& manner, Pose& pose);

/// Minimum-jerk step from 0 at `begin` to 1 at `end` (Flash and Hogan 1985).
double MinimumJerk(double at, double begin, double end);

}  // namespace mocurate
