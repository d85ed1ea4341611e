#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"

namespace mocurate {

/// One file a stage reads. `role` says what it is to the stage ("evidence", "proportions", "dataset", "source").
struct StageInput {
  std::string role;
  std::string name;            ///< stable text (clip id, relative file name); part of the cache key
  std::filesystem::path path;  ///< where it lies now; never part of the key
  std::string sha256;          ///< content; the key
};

/// One item of work, resolved: what a worker gets.
struct StageRequest {
  std::string stage;
  std::string item;        ///< stable text: clip id, person, "dataset"
  nlohmann::json options;  ///< of this stage only, complete
  std::vector<StageInput> inputs;
  std::filesystem::path output;   ///< a temporary path to write the artifact to
  std::filesystem::path scratch;  ///< folder of this item that survives kills (partial checkpoints)
};

enum class OutcomeKind { kDone, kDoubtful, kRefused, kCrashed };
std::string_view Name(OutcomeKind kind);

/// What became of an item. kDone and kDoubtful have an artifact. kRefused has none and is cached with its reason;
/// kCrashed (killed, out of time or memory) is never cached.
struct StageOutcome {
  OutcomeKind kind = OutcomeKind::kDone;
  std::vector<Finding> findings;
  nlohmann::json summary = nlohmann::json::object();  ///< figures for report and log; must not hold times
  Error error;                                        ///< why, when refused or crashed
};

/// The work itself: a pure function of the request. An Error return is kRefused with that error, except kCannotWrite,
/// kMissingOnHost, kInterrupted and kInternal, which are not the item's fault and end the run.
using StageFunction = std::function<Expected<StageOutcome>(const StageRequest&)>;

/// What the runner must know of a stage. Raise `version` whenever the same inputs give other bytes.
struct StageDeclaration {
  std::string name;
  int version = 1;
  std::string worker;  ///< program that does it: "mocurate-annotate", "mocurate-learn"
};

}  // namespace mocurate
