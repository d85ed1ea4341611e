#pragma once

#include <string>
#include <vector>

#include "ingest/synthetic/actions.h"
#include "ingest/synthetic/performance.h"

namespace mocurate {

/// An action of a longer performance, frames [begin, end).
struct ScriptedAction {
  std::string action;
  int begin = 0;
  int end = 0;
  Manner manner;
};

/// A person's performance, one action after the other. Between two actions, and before the first and after the last,
/// the person stands or sits as the actions require. Transitions have minimum jerk; the person steps back to the
/// starting point and rotates to the heading again. A script may also be a single action over all frames.
struct Script {
  int frames = 0;
  std::vector<ScriptedAction> actions;  ///< sorted, not overlapping
  double sway_phase = 0.0;
  double heading = 0.0;  ///< radians about +y, 0: facing +z
  double transition_s = 1.1;
};

/// A span of a script that is no action: the transition to the next one.
struct ScriptSpan {
  int begin = 0;
  int end = 0;
};

/// Frames of the transitions between actions. (actions - 1), at most the gap between them.
std::vector<ScriptSpan> Transitions(const Script& script, FrameRate rate);

/// MoveBody of the poses of every frame of the script from (0, 0, 0).
Motion PerformScript(const Script& script, const Subject& subject, const SkeletonPtr& skeleton, FrameRate rate);

}  // namespace mocurate
