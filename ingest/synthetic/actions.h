#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "ingest/synthetic/pose.h"

namespace mocurate {

/// How one repetition is performed.
struct Manner {
  double amplitude = 1.0;
  double phase = 0.0;     ///< radians, of movements that go to and fro
  double cycles = 2.0;    ///< of movements that repeat
  double active_s = 2.0;  ///< seconds from the first to the last movement
  bool seated = false;    ///< on a chair all the time
  double turn = 0.0;      ///< radians about +y from the first to the last movement: walks in a circle
};

/// Names of what a subject can perform, sorted: simple ones (clap, jump, kick, ...), HumanAct12's 34 variants
/// (humanact12_set.h) and what other sets ask for.
std::vector<std::string> KnownActions();

/// Error kConfig for an unknown name, with the nearest known one.
Status CheckAction(const std::string& name);

/// Seconds of one cycle at the tempo of everyday life; 0 for what is done once. Known actions only.
double NaturalPeriod(const std::string& action);

/// Seconds that the action takes with so many cycles.
double NaturalDuration(const std::string& action, double cycles);

/// Moves `pose` (standing) to where the action is at `progress` in [0, 1] of its time. One-handed ones that do not name
/// a side lead with the right. Known actions only.
void Perform(const std::string& action, double progress, const Manner& manner, Pose& pose);

/// Minimum-jerk step from 0 at `begin` to 1 at `end` (Flash and Hogan 1985).
double MinimumJerk(double at, double begin, double end);

}  // namespace mocurate
