#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/pipeline/stage.h"
#include "core/pipeline/wire.h"

namespace mocurate {

/// Options of one item: those of its stage, which copies share, and its own, which precede them. A run holds 100,000
/// items, and the options of a source are some 20 KB.
class ItemOptions {
 public:
  ItemOptions() : ItemOptions(nlohmann::json::object()) {}
  ItemOptions(nlohmann::json::initializer_list_t shared) : ItemOptions(nlohmann::json(shared)) {}
  ItemOptions(nlohmann::json shared) {
    std::string text = CanonicalText(shared);
    shared_ = std::make_shared<const Shared>(Shared{std::move(shared), std::move(text)});
  }

  /// Sets an option of this item alone.
  void Set(const std::string& name, nlohmann::json value) { own_[name] = std::move(value); }

  bool contains(const std::string& name) const { return own_.contains(name) || shared_->options.contains(name); }
  const nlohmann::json& at(const std::string& name) const {
    const auto own = own_.find(name);
    return own != own_.end() ? *own : shared_->options.at(name);
  }
  template <class T>
  T value(const std::string& name, const T& otherwise) const {
    return contains(name) ? at(name).get<T>() : otherwise;
  }

  /// All of them, in one object.
  nlohmann::json Whole() const {
    nlohmann::json whole = shared_->options;
    whole.update(own_);
    return whole;
  }

  /// CanonicalText of all of them.
  std::string Text() const { return own_.empty() ? shared_->text : CanonicalText(Whole()); }

 private:
  struct Shared {
    nlohmann::json options;
    std::string text;
  };
  std::shared_ptr<const Shared> shared_;
  nlohmann::json own_ = nlohmann::json::object();
};

inline bool operator==(const ItemOptions& a, const ItemOptions& b) { return a.Whole() == b.Whole(); }

/// A value to keep, in memory of just its size.
inline std::vector<std::uint8_t> Packed(const nlohmann::json& value) {
  const std::vector<std::uint8_t> packed = nlohmann::json::to_cbor(value);
  return {packed.begin(), packed.end()};
}

/// Figures about an item: an object of JSON that is kept packed, which copies share. A run holds some 100,000 of them;
/// as trees they take several times the memory. Each access unpacks it.
class ItemSummary {
 public:
  ItemSummary() = default;  ///< an empty object
  ItemSummary(const nlohmann::json& object)
      : packed_(std::make_shared<const std::vector<std::uint8_t>>(Packed(object))) {}
  ItemSummary(nlohmann::json::initializer_list_t object) : ItemSummary(nlohmann::json(object)) {}

  nlohmann::json Unpacked() const {
    return packed_ == nullptr ? nlohmann::json::object() : nlohmann::json::from_cbor(*packed_);
  }
  bool contains(const std::string& name) const { return Unpacked().contains(name); }
  nlohmann::json at(const std::string& name) const { return Unpacked().at(name); }
  template <class T>
  T value(const std::string& name, const T& otherwise) const {
    return Unpacked().value(name, otherwise);
  }
  void Set(const std::string& name, nlohmann::json value) {
    nlohmann::json object = Unpacked();
    object[name] = std::move(value);
    *this = object;
  }

 private:
  std::shared_ptr<const std::vector<std::uint8_t>> packed_;
};

inline void to_json(nlohmann::json& json, const ItemSummary& summary) { json = summary.Unpacked(); }
inline bool operator==(const ItemSummary& a, const ItemSummary& b) { return a.Unpacked() == b.Unpacked(); }

/// Cores that this process may use.
int AvailableCores();

struct ItemSpec {
  std::string item;
  ItemOptions options;
  std::vector<StageInput> inputs;  ///< sha256 may be empty for source files: the runner hashes them
};

/// What a plan asks of a runner: of the first of `stages` that lacks items they are gathered; of a single one even
/// where none is missing. Earlier stages are served from the cache, later ones only looked up.
struct PlanRequest {
  std::vector<std::string> stages;
  std::size_t most = 32;           ///< missing items of each earlier stage that are executed at once, at most
  std::set<std::string> given_up;  ///< stages whose missing items are left out, up to the share `tolerated` of all
  double tolerated = 0.0;
  /// Number of missing items of a stage that are executed at once, to know how long they take; empty: none.
  std::function<std::size_t(const std::string& stage)> pilot;
  /// Called once per run of the stage with its other missing items, whose inputs have their hashes, and the mean
  /// seconds of the pilot's; 0 without one.
  std::function<Status(const StageDeclaration& stage, std::vector<ItemSpec> missing, double seconds)> take;
};

struct RunnerOptions {
  std::filesystem::path run_folder;     ///< journal.jsonl, curation_log.jsonl, lock
  std::filesystem::path cache_folder;   ///< empty: $MOCURATE_CACHE, else ${XDG_CACHE_HOME:-~/.cache}/mocurate
  std::filesystem::path worker_folder;  ///< where worker programs lie; empty: relative to this program
  int jobs = 0;                         ///< worker processes; 0: one per core
  bool dry_run = false;
  bool quiet = false;                              ///< no progress and no output of workers
  bool log_failures = true;                        ///< as warnings, when they happen; false: the caller reports
  std::optional<double> item_timeout_s;            ///< instead of the stages' own limits
  std::optional<std::uint64_t> item_memory_bytes;  ///< instead of the stages' own limits
  double time_factor = 1.0;                        ///< the stages' own time limits are this many times as long
  std::filesystem::path node_folder;               ///< for outputs until they are in the cache; empty: in the cache
  std::filesystem::path task_journal;  ///< of a task of a plan: instead of journal.jsonl, and the run folder is not
                                       ///< locked; inputs in the cache may appear late
  std::optional<PlanRequest> plan;     ///< with dry_run
};

/// Item after its stage.
struct ItemResult {
  std::string item;
  Outcome outcome;
  PathText artifact;   ///< in the cache; empty without one
  std::string sha256;  ///< of the artifact's content
  bool from_cache = false;
  ItemSummary summary;  ///< of the stage's outcome
};

struct StageCounts {
  std::string stage;
  std::string branch;     ///< which of several runs of the stage this is, in words; empty when there is one
  std::size_t total = 0;  ///< items
  int done = 0, suspect = 0, excluded = 0, refused = 0, crashed = 0, from_cache = 0;
  int unrecorded = 0;  ///< refused for this machine's files or options: not in the cache, tried again by the next run
  double seconds = 0.0;

  /// "canon", or with a branch "canon (raw tracks)".
  std::string title() const { return branch.empty() ? stage : stage + " (" + branch + ")"; }
};

struct StageReport : StageCounts {
  std::vector<ItemResult> items;  ///< in the order of the specs
};

/// Content-addressed cache: key -> artifact bytes + outcome. Visible entries are complete.
class Cache {
 public:
  explicit Cache(std::filesystem::path folder);
  const std::filesystem::path& folder() const { return folder_; }

  struct Entry {
    StageOutcome outcome;
    std::filesystem::path artifact;
    std::string sha256;
  };
  /// Key of an item: SHA-256 over stage name, version, item, canonical options, role + name + content of the inputs.
  static std::string Key(const StageDeclaration& stage, const ItemSpec& spec);
  std::optional<Entry> Find(const std::string& key) const;
  /// Moves `temporary` (may be empty: no artifact) into the cache. Two processes may race; the same bytes win.
  Expected<Entry> Put(const std::string& key, const std::filesystem::path& temporary, const StageOutcome& outcome);

  struct Statistics {
    std::size_t objects = 0;
    std::uint64_t bytes = 0;
  };
  Statistics Stat() const;
  /// Compares every artifact with its recorded hash; returns the keys that do not agree.
  std::vector<std::string> Verify() const;
  /// Removes objects not used for `days`; with `dry_run` only counts them. Only what the cache made is removed, and no
  /// link is followed.
  Statistics Prune(double days, bool dry_run = false);
  /// Who else may change what is served from here, as a message; empty: no other user.
  std::string OthersWhoWrite() const;

 private:
  std::filesystem::path folder_;
};

/// Runs stages of items over worker processes, one stage after the other. Holds the lock of the run folder.
class Runner {
 public:
  static Expected<std::unique_ptr<Runner>> Make(const RunnerOptions& options);
  ~Runner();

  /// Errors: kInterrupted after SIGINT/SIGTERM (items in flight are finished first), kCannotWrite, kMissingOnHost,
  /// kInternal. Failing items are in the report, not errors. With dry_run nothing is executed: `from_cache` lists the
  /// items that would be served; later stages whose inputs are unknown report zero items. With a plan: kInconsistent
  /// where an earlier stage lacks too many items, kTooManyFailures where one that was given up does. `branch` names one
  /// of several runs of a stage in messages.
  Expected<StageReport> Run(const StageDeclaration& stage, std::vector<ItemSpec> items, const std::string& branch = {});

  const RunnerOptions& options() const;

 private:
  struct Impl;
  explicit Runner(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

std::filesystem::path DefaultCacheFolder();

}  // namespace mocurate
