#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/options.h"
#include "core/motion/request.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {

/// An action of a script as written; 0 frames: the network's usual number.
struct ScriptActionOptions {
  std::string action;
  std::int64_t frames = 0;
  std::int64_t transition_frames = 0;  ///< of the transition before it
  void Declare(OptionVisitor& v);
};

/// A script of actions, a YAML file: `actions: [{action: throw, frames: 20, transition_frames: 14}, ...]`.
struct ScriptOptions {
  std::string name, description;
  std::vector<ScriptActionOptions> actions;
  void Declare(OptionVisitor& v);
};

/// "throw,catch:30,throw" (an action and its frames), a name of configs/scripts, or a YAML file. Errors: kUsage for
/// other texts, and those of the file.
Expected<ScriptOptions> ReadScript(const std::string& text);

/// The steps of a script for a network: classes by name or index; without durations in the script, usual ones of the
/// network's training set. `continues`: a transition precedes the first action too. Error kUsage names the step, the
/// value and the valid ones.
Expected<std::vector<ScriptStep>> StepsOf(const ScriptOptions& script, const Checkpoint& network, bool continues);

}  // namespace mocurate
