#include "core/pipeline/stage_run.h"

#include <thread>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/pipeline/cache_layout.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Items are looked up in slices of this length while workers are waiting for answers to be read.
constexpr std::chrono::milliseconds kSlice{20};
/// NFS clients may keep a missing name for this long (default acdirmax).
constexpr std::chrono::seconds kLatestInput{60};
constexpr std::chrono::milliseconds kAskAgain{500};

/// Refusals that depend on the machine's files, not on the content behind the key, are not cached.
bool MayBeCached(const Outcome& outcome) {
  if (outcome.kind == OutcomeKind::kCrashed) return false;
  return outcome.kind != OutcomeKind::kRefused ||
         (outcome.error.code != ErrorCode::kNotFound && outcome.error.code != ErrorCode::kUnreadable &&
          outcome.error.code != ErrorCode::kConfig);
}

ItemResult Served(const std::string& item, Cache::Entry entry) {
  ItemSummary summary = entry.outcome.summary;
  return {item, std::move(entry.outcome), std::move(entry.artifact), std::move(entry.sha256), true, std::move(summary)};
}

/// Whether an object of the cache holds the bytes that its record declares.
bool Holds(const fs::path& artifact, const std::string& sha256) {
  const Expected<Content> content = ContentOf(artifact);
  return content && content->sha256 == sha256;
}

}  // namespace

void CountItem(const ItemResult& result, StageReport& report) {
  report.done += result.outcome.kind == OutcomeKind::kDone ? 1 : 0;
  report.suspect += result.outcome.kind == OutcomeKind::kSuspect ? 1 : 0;
  report.excluded += result.outcome.kind == OutcomeKind::kExcluded ? 1 : 0;
  report.refused += result.outcome.kind == OutcomeKind::kRefused ? 1 : 0;
  report.crashed += result.outcome.kind == OutcomeKind::kCrashed ? 1 : 0;
  report.from_cache += result.from_cache ? 1 : 0;
  report.unrecorded += result.outcome.kind == OutcomeKind::kRefused && !MayBeCached(result.outcome) ? 1 : 0;
}

std::vector<fs::path> DamagedInputs(const RunnerState& state, const ItemSpec& spec) {
  std::vector<fs::path> damaged;
  for (const StageInput& input : spec.inputs) {
    if (!IsObject(state.options.cache_folder, input.path) || Holds(input.path, input.sha256)) continue;
    damaged.push_back(input.path);
  }
  return damaged;
}

StageRun::StageRun(RunnerState& state, const StageDeclaration& stage, std::vector<ItemSpec> items, bool defer_damaged)
    : state_(state),
      stage_(stage),
      items_(std::move(items)),
      defer_damaged_(defer_damaged),
      progress_(stage.name, items_.size(), !state.options.quiet && !state.options.dry_run,
                state.options.dry_run || !state.options.task_journal.empty()
                    ? fs::path()
                    : state.options.run_folder / kProgressFile) {
  report_.stage = stage.name;
  report_.total = items_.size();
  report_.items.resize(items_.size());
  for (std::size_t i = 0; i < items_.size(); ++i) report_.items[i].item = items_[i].item;
}

StageRun::~StageRun() {
  for (const std::unique_ptr<Seat>& seat : seats_) {
    if (seat->worker != nullptr && (seat->task || !seat->said_hello)) seat->worker->Reap();
  }
}

Expected<StageReport> StageRun::Execute() {
  const Clock::time_point start = Clock::now();
  while (true) {
    HandleSignals();
    if (abandoned_) break;
    if (!fatal_) PrepareItems();
    if (!fatal_) AssignWorkers();
    if (fatal_) ready_.clear();
    if (!Working() && (fatal_ || (ready_.empty() && next_ == items_.size()))) break;
    WaitForWorkers();
    progress_.Draw();
  }
  progress_.Clear();
  for (std::unique_ptr<Seat>& seat : seats_) {
    if (seat->worker != nullptr && seat->said_hello && !seat->task) state_.idle.push_back(std::move(seat->worker));
  }
  if (fatal_) return tl::unexpected<Error>(*fatal_);
  report_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return std::move(report_);
}

StageReport StageRun::PlanStage() {
  looked_up_ = true;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (!HashInputs(i)) continue;
    std::optional<Cache::Entry> entry = state_.cache.Find(Cache::Key(stage_, items_[i]));
    if (!entry) continue;
    report_.items[i] = Served(items_[i].item, *std::move(entry));
    CountItem(report_.items[i], report_);
  }
  return std::move(report_);
}

bool StageRun::Working() const {
  for (const std::unique_ptr<Seat>& seat : seats_) {
    if (seat->task) return true;
  }
  return false;
}

/// Looks items up, in their order, until every worker has something to do.
void StageRun::PrepareItems() {
  const Clock::time_point begin = Clock::now();
  const bool waits = !state_.options.task_journal.empty();
  while (next_ < items_.size() && ready_.size() < static_cast<std::size_t>(state_.options.jobs) && !fatal_) {
    if (Interruption::Count() > 0 || (Clock::now() - begin > kSlice && Working())) return;
    const std::size_t index = next_++;
    if (!HashInputs(index)) continue;
    std::string key = Cache::Key(stage_, items_[index]);
    if (std::optional<Cache::Entry> entry = FindWhole(key)) {
      Record(index, key, Served(items_[index].item, *std::move(entry)), 0.0);
    } else {
      if (waits) WaitForInputs(items_[index]);
      if (waits && !CheckInputs(index)) continue;
      Task task;
      task.index = index;
      task.key = std::move(key);
      ready_.push_back(std::move(task));
    }
    progress_.Draw();
  }
}

/// Artifacts of stages over the whole set are few, large and copied out of the cache: their bytes are verified before
/// they are served. Artifacts of clips are verified when a stage fails on them.
std::optional<Cache::Entry> StageRun::FindWhole(const std::string& key) const {
  std::optional<Cache::Entry> entry = state_.cache.Find(key);
  const bool whole_set = !stage_.limits.memory_bytes;
  if (!entry || !whole_set || entry->artifact.empty() || Holds(entry->artifact, entry->sha256)) return entry;
  LogWarning("cache: " + DisplayPath(entry->artifact) + " does not hold the bytes that were recorded: made again");
  DropObject(state_.options.cache_folder, entry->artifact);
  return std::nullopt;
}

/// On a file system shared by nodes an artifact may appear late; a stage waits for all of its inputs a minute. Listing
/// its folder makes this node ask again.
void StageRun::WaitForInputs(const ItemSpec& spec) {
  for (const StageInput& input : spec.inputs) {
    std::error_code problem;
    while (IsObject(state_.options.cache_folder, input.path) && !fs::exists(input.path, problem) &&
           Interruption::Count() == 0) {
      if (!waiting_since_) waiting_since_ = Clock::now();
      if (Clock::now() - *waiting_since_ > kLatestInput) return;
      for (fs::directory_iterator it(fs::path(input.path).parent_path(), problem), end; !problem && it != end;)
        it.increment(problem);
      std::this_thread::sleep_for(kAskAgain);
    }
  }
}

/// False, and the item is refused, when a source cannot be read.
bool StageRun::HashInputs(std::size_t index) {
  for (StageInput& input : items_[index].inputs) {
    if (!input.sha256.empty()) continue;
    Expected<std::string> sha256 = state_.memo.Sha256Of(input.path);
    if (sha256) {
      input.sha256 = *std::move(sha256);
      continue;
    }
    Refuse(index, sha256.error());
    return false;
  }
  return true;
}

/// False, and the item is refused, when an input of a plan's task has other bytes than the plan says: what would be
/// made of it would be served to others under the wrong key.
bool StageRun::CheckInputs(std::size_t index) {
  for (const StageInput& input : items_[index].inputs) {
    if (input.path.empty()) continue;
    const Expected<std::string> sha256 = state_.memo.Sha256Of(input.path);
    if (sha256 && *sha256 == input.sha256) continue;
    Refuse(index, sha256 ? Error{ErrorCode::kUnreadable, "the content is not that of the plan", DisplayPath(input.path),
                                 "it has changed since, or the plan is not of this data: plan again, mocurate plan"}
                         : sha256.error());
    return false;
  }
  return true;
}

/// Without a line in the cache: the next run tries again.
void StageRun::Refuse(std::size_t index, const Error& error) {
  Record(index, "", {items_[index].item, {OutcomeKind::kRefused, {}, error}, {}, {}, false, {}}, 0.0);
}

void StageRun::Dispatch(Seat& seat, Task task) {
  if (!state_.workspace) {
    Expected<Workspace> workspace = Workspace::Make(state_.options.cache_folder, state_.options.node_folder);
    if (!workspace) return GiveUp(workspace.error());
    state_.workspace = *std::move(workspace);
  }
  const Expected<fs::path> folder = state_.workspace->NewFolder();
  if (!folder) return GiveUp(folder.error());
  Expected<Workspace::Scratch> scratch = state_.workspace->ScratchOf(task.key);
  if (!scratch) return GiveUp(scratch.error());
  task.folder = *folder;
  task.scratch = *std::move(scratch);
  task.start = Clock::now();
  const ItemSpec& spec = items_[task.index];
  const int side_by_side = std::max(1, std::min(state_.options.jobs, static_cast<int>(items_.size())));
  json request = StageRequest{stage_.name,
                              spec.item,
                              spec.options.Whole(),
                              {},
                              task.folder / "artifact",
                              task.scratch.folder,
                              std::max(1, state_.options.jobs / side_by_side)};
  request["inputs"] = spec.inputs;  // of a stage over the whole set there are many: no further copy
  seat.worker->Send(request);
  seat.task = std::move(task);
}

/// The seat's item has its outcome: keeps the artifact, cleans up, records.
void StageRun::Finish(Seat& seat, StageOutcome outcome) {
  Task task = *std::move(seat.task);
  seat.task.reset();
  const double seconds = std::chrono::duration<double>(Clock::now() - task.start).count();
  const std::uint64_t peak_memory = seat.worker ? seat.worker->PeakMemoryBytes() : 0;
  std::error_code ignored;
  if (HasArtifact(outcome.kind) && !fs::exists(task.folder / "artifact", ignored)) {
    outcome.kind = OutcomeKind::kCrashed;
    outcome.error = {ErrorCode::kInternal, "stage " + stage_.name + " wrote no artifact", items_[task.index].item, {}};
  }
  ItemResult result{items_[task.index].item, {}, {}, {}, false, outcome.summary};
  const bool crashed = outcome.kind == OutcomeKind::kCrashed;
  const bool damaged = IsFailure(outcome.kind) && !DamagedInputs(state_, items_[task.index]).empty();
  if (damaged && defer_damaged_) {
    damaged_.push_back(task.index);
    fs::remove_all(task.folder, ignored);
    return;
  }
  if (MayBeCached(outcome) && !damaged) {
    Expected<Cache::Entry> entry = Keep(task, outcome);
    if (!entry) return GiveUp(entry.error());
    result.artifact = std::move(entry->artifact);
    result.sha256 = std::move(entry->sha256);
  }
  result.outcome = std::move(outcome);
  fs::remove_all(task.folder, ignored);
  // Files of a refused item are kept: its message names them, e.g. the batch at which a training diverged.
  const bool shows = result.outcome.kind == OutcomeKind::kRefused && task.scratch.HoldsFiles();
  if (!crashed && !shows) state_.workspace->Discard(task.scratch);
  Record(task.index, task.key, std::move(result), seconds, peak_memory);
}

Expected<Cache::Entry> StageRun::Keep(const Task& task, const StageOutcome& outcome) {
  return state_.cache.Put(task.key, HasArtifact(outcome.kind) ? task.folder / "artifact" : fs::path(), outcome);
}

void StageRun::Record(std::size_t index, const std::string& key, ItemResult result, double seconds,
                      std::uint64_t peak_memory) {
  const Outcome& outcome = result.outcome;
  const bool failed = IsFailure(outcome.kind);
  progress_.Count(result.item, !result.from_cache, failed);
  if (!looked_up_) {
    json entry = {{"stage", stage_.name},
                  {"item", result.item},
                  {"key", key},
                  {"outcome", Name(outcome.kind)},
                  {"from_cache", result.from_cache},
                  {"seconds", seconds}};
    if (peak_memory > 0) entry["peak_memory_bytes"] = peak_memory;
    if (!HasArtifact(outcome.kind)) entry["reason"] = outcome.error.Message();
    if (Status added = state_.journal.Add(std::move(entry)); !added) GiveUp(added.error());
    if (failed && !result.from_cache && state_.options.log_failures) {
      progress_.Clear();
      LogWarning(stage_.name + ": " + DisplayPath(result.item) + " " + std::string(Name(outcome.kind)) + ": " +
                 outcome.error.Message());
    }
  }
  CountItem(result, report_);
  report_.items[index] = std::move(result);
}

/// Ends the run: items in work are finished, nothing new is begun. The first error is kept.
void StageRun::GiveUp(const Error& error) {
  if (!fatal_) fatal_ = error;
}

Error StageRun::Interrupted() const {
  return {ErrorCode::kInterrupted,
          std::string("stopped by ") + Interruption::SignalName() + " in stage " + stage_.name + " after " +
              std::to_string(report_.done + report_.suspect + report_.excluded + report_.refused + report_.crashed) +
              " of " + Counted(static_cast<long long>(items_.size()), "item"),
          {},
          "run the same command again to continue"};
}

void Origins::Add(const StageDeclaration& stage, const ItemSpec& spec, const std::filesystem::path& artifact) {
  if (stages_.empty() || stages_.back().name != stage.name) stages_.push_back(stage);
  Known& known = known_[artifact.filename().native()];
  known = {stages_.size() - 1, spec.item, spec.options, {}};
  known.inputs.reserve(spec.inputs.size());
  for (const StageInput& input : spec.inputs) known.inputs.push_back(Packed(input));
}

std::optional<Origins::Origin> Origins::Of(const std::filesystem::path& artifact) const {
  const auto found = known_.find(artifact.filename().native());
  if (found == known_.end()) return std::nullopt;
  const Known& known = found->second;
  Origin origin{stages_[known.stage], {known.item, known.options, {}}};
  for (const std::vector<std::uint8_t>& packed : known.inputs) {
    origin.spec.inputs.push_back(json::from_cbor(packed).get<StageInput>());
  }
  return origin;
}

}  // namespace mocurate
