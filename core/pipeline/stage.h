#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"

namespace mocurate {

/// A path to keep: std::filesystem::path also keeps its parts, some 600 bytes.
class PathText {
 public:
  PathText() = default;
  PathText(const std::filesystem::path& path) : text_(path.native()) {}
  PathText(std::string path) : text_(std::move(path)) {}
  PathText(const char* path) : text_(path) {}

  operator std::filesystem::path() const { return text_; }
  const std::string& native() const { return text_; }
  bool empty() const { return text_.empty(); }
  void clear() { text_.clear(); }

 private:
  std::string text_;
};

inline bool operator==(const PathText& a, const PathText& b) { return a.native() == b.native(); }
inline void to_json(nlohmann::json& json, const PathText& path) { json = path.native(); }
inline void from_json(const nlohmann::json& json, PathText& path) { path = json.get<std::string>(); }

/// One file a stage reads. `role` is its purpose ("evidence", "proportions", "dataset", "source").
struct StageInput {
  std::string role;
  std::string name;    ///< stable text (clip id, relative file name); part of the cache key
  PathText path;       ///< where it lies now; never part of the key; empty: the stage finds it by its name
  std::string sha256;  ///< content; the key
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StageInput, role, name, path, sha256)

/// One item of work, resolved: what a worker gets.
struct StageRequest {
  std::string stage;
  std::string item;        ///< stable text: clip id, person, "dataset"
  nlohmann::json options;  ///< of this stage only, complete
  std::vector<StageInput> inputs;
  std::filesystem::path output;   ///< a temporary path to write the artifact to
  std::filesystem::path scratch;  ///< folder of this item that survives kills (partial checkpoints)
  int threads = 1;                ///< the item may use; never changes its bytes
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StageRequest, stage, item, options, inputs, output, scratch, threads)

/// The input of a role; null when there is none.
inline const StageInput* FindInput(const StageRequest& request, std::string_view role) {
  for (const StageInput& input : request.inputs) {
    if (input.role == role) return &input;
  }
  return nullptr;
}

/// kDone, kSuspect: there is an artifact. kExcluded: none, by a rule of the configuration; this is not a failure.
/// kRefused: none, because the input cannot be used. kCrashed: none, because the worker was killed, or ran out of time
/// or memory.
enum class OutcomeKind { kDone, kSuspect, kExcluded, kRefused, kCrashed };
std::string_view Name(OutcomeKind kind);

/// Whether an item that ended so has an artifact.
inline bool HasArtifact(OutcomeKind kind) { return kind == OutcomeKind::kDone || kind == OutcomeKind::kSuspect; }
/// Whether it counts as a failure.
inline bool IsFailure(OutcomeKind kind) { return kind == OutcomeKind::kRefused || kind == OutcomeKind::kCrashed; }

/// What became of an item. All but kCrashed are cached, with their reason.
struct Outcome {
  OutcomeKind kind = OutcomeKind::kDone;
  std::vector<Finding> findings;
  Error error;  ///< why there is no artifact; with kExcluded the last finding names the rule
};

/// The same as a stage returns it.
struct StageOutcome : Outcome {
  nlohmann::json summary = nlohmann::json::object();  ///< figures for report and log; must not hold times
};

/// The work itself: a pure function of the request. An Error return is kRefused with that error, except kCannotWrite,
/// kMissingOnHost, kInterrupted and kInternal, which are not the item's fault and end the run.
using StageFunction = std::function<Expected<StageOutcome>(const StageRequest&)>;

/// What one item may take before it is ended: a guard against what hangs or swallows the machine, far above what sound
/// input needs.
struct ItemLimits {
  double time_s = 3600.0;
  std::optional<std::uint64_t> memory_bytes;  ///< resident memory of the worker; absent: unlimited
};

/// Of stages that look at one clip.
inline ItemLimits ClipLimits() { return {3600.0, std::uint64_t{8} << 30}; }
/// Of stages that solve for one clip, or for a person's few.
inline ItemLimits SolverLimits() { return {86400.0, std::uint64_t{16} << 30}; }
/// Of stages that hold a whole set in memory, or work as long as the configuration requests.
inline ItemLimits WholeSetLimits() { return {86400.0, std::nullopt}; }

/// What the runner must know of a stage. Raise `version` whenever the same inputs give other bytes.
struct StageDeclaration {
  std::string name;
  int version = 1;
  std::string worker;  ///< program that does it: "mocurate-annotate", "mocurate-learn"
  ItemLimits limits{};
};

}  // namespace mocurate
