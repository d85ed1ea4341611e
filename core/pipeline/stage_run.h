#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/content.h"
#include "core/pipeline/interruption.h"
#include "core/pipeline/journal.h"
#include "core/pipeline/lock.h"
#include "core/pipeline/progress.h"
#include "core/pipeline/runner.h"
#include "core/pipeline/worker_process.h"
#include "core/pipeline/workspace.h"

namespace mocurate {

/// How the artifacts of one runner were made, so that a damaged one can be made again.
class Origins {
 public:
  struct Origin {
    StageDeclaration stage;
    ItemSpec spec;
  };
  void Add(const StageDeclaration& stage, const ItemSpec& spec, const std::filesystem::path& artifact);
  /// Empty for an artifact that this runner does not know.
  std::optional<Origin> Of(const std::filesystem::path& artifact) const;

 private:
  struct Known {
    std::size_t stage = 0;  ///< in stages_
    std::string item;
    ItemOptions options;
    std::vector<std::vector<std::uint8_t>> inputs;  ///< each packed: a run holds 100,000 items of each stage
  };
  std::vector<StageDeclaration> stages_;
  std::map<std::string, Known> known_;  ///< by name of the artifact's file, which holds most of its key
};

/// What a runner keeps from stage to stage.
struct RunnerState {
  explicit RunnerState(const RunnerOptions& chosen) : options(chosen), cache(chosen.cache_folder) {}

  RunnerOptions options;  ///< resolved: no empty folder, jobs > 0
  Cache cache;
  ContentMemo memo;
  Origins origins;
  std::optional<FileLock> lock;
  Journal journal;
  std::optional<Workspace> workspace;  ///< made when the first item is executed
  std::unique_ptr<Interruption> interruption;
  std::vector<std::unique_ptr<WorkerProcess>> idle;  ///< workers waiting for the next stage
};

void CountItem(const ItemResult& result, StageReport& report);

/// Inputs of an item that lie in the cache and do not hold the bytes that were recorded when they were made.
std::vector<std::filesystem::path> DamagedInputs(const RunnerState& state, const ItemSpec& spec);

/// Where a worker program lies. Error kMissingOnHost.
Expected<std::filesystem::path> FindWorkerProgram(const RunnerOptions& options, const std::string& name);

/// One stage over its items: serves from the cache, hands the rest to workers, records what becomes of each.
class StageRun {
 public:
  /// With `defer_damaged` an item that fails on a damaged input is not recorded but named by damaged(), so that it can
  /// be tried again.
  StageRun(RunnerState& state, const StageDeclaration& stage, std::vector<ItemSpec> items, bool defer_damaged = false);
  ~StageRun();
  Expected<StageReport> Execute();
  /// Only asks the cache.
  StageReport PlanStage();

  const std::vector<ItemSpec>& items() const { return items_; }
  /// Places in items().
  const std::vector<std::size_t>& damaged() const { return damaged_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// An item that is not in the cache.
  struct Task {
    std::size_t index = 0;
    std::string key;
    std::filesystem::path folder;  ///< holds the temporary output
    Workspace::Scratch scratch;
    Clock::time_point start;
  };
  struct Seat {
    std::unique_ptr<WorkerProcess> worker;
    bool said_hello = false;  ///< its libraries are loaded and its hello has arrived
    std::optional<Task> task;
    Clock::time_point start;
    std::string verdict;  ///< why we killed it; empty when we did not
    std::string way_out;
  };

  // Items
  void PrepareItems();
  bool HashInputs(std::size_t index);
  bool CheckInputs(std::size_t index);
  void Refuse(std::size_t index, const Error& error);
  void WaitForInputs(const ItemSpec& spec);
  std::optional<Cache::Entry> FindWhole(const std::string& key) const;
  void Dispatch(Seat& seat, Task task);
  void Finish(Seat& seat, StageOutcome outcome);
  Expected<Cache::Entry> Keep(const Task& task, const StageOutcome& outcome);
  void Record(std::size_t index, const std::string& key, ItemResult result, double seconds,
              std::uint64_t peak_memory = 0);
  void GiveUp(const Error& error);

  // Workers
  void AssignWorkers();
  void StartWorker();
  void WaitForWorkers();
  void Serve(Seat& seat);
  void Answer(Seat& seat, const nlohmann::json& message);
  void OnHello(Seat& seat, const nlohmann::json& stages);
  void Lost(Seat& seat);
  ItemLimits Limits() const;
  void CheckLimits(Seat& seat);
  void HandleSignals();
  void Forward(WorkerProcess& worker);
  bool Working() const;
  Error Interrupted() const;

  RunnerState& state_;
  StageDeclaration stage_;
  std::vector<ItemSpec> items_;
  bool defer_damaged_ = false;
  std::vector<std::size_t> damaged_;
  StageReport report_;
  Progress progress_;
  std::size_t next_ = 0;    ///< first item not looked at yet
  std::deque<Task> ready_;  ///< items to execute
  std::vector<std::unique_ptr<Seat>> seats_;
  std::filesystem::path program_;
  int failed_starts_ = 0;
  std::optional<Error> fatal_;                      ///< set: nothing new is begun
  bool looked_up_ = false;                          ///< nothing is executed, and the journal has no line of it
  std::optional<Clock::time_point> waiting_since_;  ///< for inputs that appear late
  std::optional<Clock::time_point> warned_;         ///< when the batch system said that time is nearly up
  bool abandoned_ = false;                          ///< second signal: nothing is waited for either
};

}  // namespace mocurate
