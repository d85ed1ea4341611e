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
};

/// Names of what a subject can perform, sorted: clap, jump, kick, punch, sit, squat, throw, turn, walk, wave.
std::vector<std::string> KnownActions();

/// Error kConfig for an unknown name, with the nearest known one.
Status CheckAction(const std::string& name);

/// Moves `pose` (standing) to where the action is at `progress` in [0, 1] of its time. The right side leads. Known
/// actions only.
void Perform(const std::string& action, double progress, const Manner& manner, Pose& pose);

/// Minimum-jerk step from 0 at `begin` to 1 at `end` (Flash and Hogan 1985).
double MinimumJerk(double at, double begin, double end);

}  // namespace mocurate
