#include "core/pipeline/runner.h"

#include <sched.h>
#include <unistd.h>
#include <cmath>

#include <algorithm>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/pipeline/cache_layout.h"
#include "core/pipeline/stage_run.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

Expected<RunnerOptions> Resolved(RunnerOptions options) {
  if (options.jobs < 0) {
    return Fail(ErrorCode::kUsage, "jobs is " + std::to_string(options.jobs), "--jobs", "0 means one per core");
  }
  if (options.run_folder.empty() && (!options.dry_run || options.plan)) {
    return Fail(ErrorCode::kUsage, "no run folder is named", {}, "name one with -o DIR");
  }
  if (options.cache_folder.empty()) options.cache_folder = DefaultCacheFolder();
  if (options.jobs == 0) options.jobs = AvailableCores();
  std::error_code problem;
  for (fs::path* folder : {&options.run_folder, &options.cache_folder, &options.worker_folder, &options.node_folder}) {
    if (!folder->empty()) *folder = fs::absolute(*folder, problem);
  }
  return options;
}

Expected<FileLock> LockRunFolder(const fs::path& folder) {
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  const fs::path file = folder / "lock";
  Expected<std::optional<FileLock>> lock = FileLock::TryTake(file);
  if (!lock) return Forward(lock);
  if (!lock->has_value()) {
    const std::string holder(Trim(ReadFile(file).value_or("")));
    return Fail(ErrorCode::kUsage, "another run is at work here: process " + (holder.empty() ? "unknown" : holder),
                DisplayPath(folder), "wait for it to end, or name another folder with -o DIR");
  }
  if (Status written = (*lock)->WriteHolder(std::to_string(getpid()) + "\n"); !written) return Forward(written);
  return *std::move(*lock);
}

std::string Summary(const StageReport& report) {
  std::string text = report.title() + ": " + Counted(static_cast<long long>(report.items.size()), "item") + ", " +
                     std::to_string(report.done) + " done";
  const std::pair<int, const char*> parts[] = {{report.suspect, " suspect"},
                                               {report.excluded, " excluded by rule"},
                                               {report.refused, " refused"},
                                               {report.crashed, " crashed"}};
  for (const auto& [count, name] : parts) {
    if (count > 0) text += ", " + std::to_string(count) + name;
  }
  text += ", " + std::to_string(report.from_cache) + " from the cache, ";
  return text + FormatDouble(static_cast<double>(std::llround(report.seconds * 10.0)) / 10.0) + " s";
}

}  // namespace

int AvailableCores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  return sched_getaffinity(0, sizeof cores, &cores) == 0 ? std::max(1, CPU_COUNT(&cores)) : 1;
}

struct Runner::Impl : RunnerState {
  using RunnerState::RunnerState;

  Expected<StageReport> Execute(const StageDeclaration& stage, std::vector<ItemSpec> items);
  Status MakeAgain(const fs::path& artifact);
  Status TryAgain(const StageDeclaration& stage, const StageRun& first, StageReport& report);
  Expected<StageReport> LookUp(const StageDeclaration& stage, std::vector<ItemSpec> items);
  Expected<StageReport> Gather(const StageDeclaration& stage, const StageRun& lookup, StageReport found,
                               const std::vector<std::size_t>& places);

  std::string gathered;  ///< the stage that is planned; empty before it
};

/// One stage; an item that fails on a damaged input from the cache is repeated after that input is made again.
Expected<StageReport> Runner::Impl::Execute(const StageDeclaration& stage, std::vector<ItemSpec> items) {
  StageRun run(*this, stage, std::move(items), true);
  Expected<StageReport> report = run.Execute();
  if (!report) return report;
  if (Status repeated = TryAgain(stage, run, *report); !repeated) return Forward(repeated);
  for (std::size_t i = 0; i < run.items().size(); ++i) {
    if (!report->items[i].artifact.empty()) origins.Add(stage, run.items()[i], report->items[i].artifact);
  }
  return report;
}

/// Deletes an artifact and runs its item again. An artifact that this runner does not know stays missing.
Status Runner::Impl::MakeAgain(const fs::path& artifact) {
  const std::optional<Origins::Origin> origin = origins.Of(artifact);
  if (!origin) {
    // Of an earlier stage that this task of a plan does not know; others may see its bytes well.
    if (!options.task_journal.empty()) return {};
    DropObject(options.cache_folder, artifact);
    return {};
  }
  LogWarning("cache: " + DisplayPath(artifact) + " does not hold the bytes that were recorded: made again");
  DropObject(options.cache_folder, artifact);
  const Expected<StageReport> made = Execute(origin->stage, {origin->spec});
  return made ? Status() : Forward(made);
}

Status Runner::Impl::TryAgain(const StageDeclaration& stage, const StageRun& first, StageReport& report) {
  if (first.damaged().empty()) return {};
  std::vector<ItemSpec> specs;
  for (const std::size_t index : first.damaged()) {
    specs.push_back(first.items()[index]);
    for (const fs::path& artifact : DamagedInputs(*this, specs.back())) {
      if (Status made = MakeAgain(artifact); !made) return made;
    }
  }
  StageRun second(*this, stage, std::move(specs));
  Expected<StageReport> again = second.Execute();
  if (!again) return Forward(again);
  for (std::size_t i = 0; i < again->items.size(); ++i) {
    CountItem(again->items[i], report);
    report.items[first.damaged()[i]] = std::move(again->items[i]);
  }
  report.seconds += again->seconds;
  return {};
}

/// A stage of a job of which another one is planned.
Expected<StageReport> Runner::Impl::LookUp(const StageDeclaration& stage, std::vector<ItemSpec> items) {
  const PlanRequest& plan = *options.plan;
  StageRun lookup(*this, stage, std::move(items));
  StageReport found = lookup.PlanStage();
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < found.items.size(); ++i) {
    const bool unreadable = found.items[i].outcome.kind == OutcomeKind::kRefused;
    if (!found.items[i].from_cache && !unreadable) missing.push_back(i);
  }
  const bool given_up = plan.given_up.count(stage.name) > 0;
  const bool wanted = !given_up && std::count(plan.stages.begin(), plan.stages.end(), stage.name) > 0;
  const bool first = gathered.empty() && wanted && (!missing.empty() || plan.stages.size() == 1);
  if (first || gathered == stage.name) return Gather(stage, lookup, std::move(found), missing);
  if (!gathered.empty() || missing.empty()) return found;
  const std::string lack = "stage " + stage.name + " has no result for " + std::to_string(missing.size()) + " of " +
                           Counted(static_cast<long long>(found.items.size()), "item");
  if (given_up) {
    if (static_cast<double>(missing.size()) <= plan.tolerated * static_cast<double>(found.items.size())) {
      for (const std::size_t i : missing) {
        found.items[i].outcome.kind = OutcomeKind::kCrashed;
        found.items[i].outcome.error = {ErrorCode::kTooManyFailures, "no task made it", stage.name, {}};
      }
      return found;
    }
    return Fail(ErrorCode::kTooManyFailures, lack + " after three attempts", "plan",
                "the journals in plan/" + stage.name +
                    " have the reasons; to go on without them, raise "
                    "tolerated_failures");
  }
  if (missing.size() > plan.most) {
    return Fail(ErrorCode::kInconsistent, lack + ", which stage " + plan.stages.front() + " needs", "plan",
                "plan and run it first: --stage " + stage.name);
  }
  std::vector<ItemSpec> left;
  for (const std::size_t i : missing) left.push_back(lookup.items()[i]);
  Expected<StageReport> made = Execute(stage, std::move(left));
  if (!made) return made;
  for (std::size_t i = 0; i < missing.size(); ++i) found.items[missing[i]] = std::move(made->items[i]);
  return found;
}

/// Hands the missing items of the planned stage over.
Expected<StageReport> Runner::Impl::Gather(const StageDeclaration& stage, const StageRun& lookup, StageReport found,
                                           const std::vector<std::size_t>& places) {
  gathered = stage.name;
  std::vector<ItemSpec> missing;
  for (const std::size_t i : places) missing.push_back(lookup.items()[i]);
  double seconds = 0.0;
  const std::size_t wanted = options.plan->pilot ? options.plan->pilot(stage.name) : 0;
  if (const std::size_t pilot = std::min(wanted, missing.size()); pilot > 0) {
    std::vector<ItemSpec> chosen, others;
    for (std::size_t i = 0; i < missing.size(); ++i) {
      const bool in_pilot = i * pilot / missing.size() != (i + 1) * pilot / missing.size();
      (in_pilot ? chosen : others).push_back(std::move(missing[i]));
    }
    const int at_once = std::min(options.jobs, static_cast<int>(chosen.size()));
    const auto executed = Execute(stage, std::move(chosen));
    if (!executed) return executed;
    LogInfo(Summary(*executed));
    seconds = executed->seconds * at_once / static_cast<double>(executed->items.size());
    missing = std::move(others);
  }
  if (Status taken = options.plan->take(stage, std::move(missing), seconds); !taken) return Forward(taken);
  return found;
}

Runner::Runner(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Runner::~Runner() {
  for (const std::unique_ptr<WorkerProcess>& worker : impl_->idle) worker->CloseStdin();
}

Expected<std::unique_ptr<Runner>> Runner::Make(const RunnerOptions& options) {
  const Expected<RunnerOptions> resolved = Resolved(options);
  if (!resolved) return Forward(resolved);
  auto impl = std::make_unique<Impl>(*resolved);
  if (Status plain = CheckNotLink(resolved->cache_folder / "objects"); !plain) return Forward(plain);
  if (const std::string others = impl->cache.OthersWhoWrite(); !others.empty()) LogWarning(others);
  if (!options.dry_run || options.plan) {
    if (options.task_journal.empty()) {
      Expected<FileLock> lock = LockRunFolder(resolved->run_folder);
      if (!lock) return Forward(lock);
      impl->lock = *std::move(lock);
    }
    // Before the journal: where there is one, a signal ends the run as documented.
    impl->interruption = std::make_unique<Interruption>();
    Expected<Journal> journal =
        Journal::Open(options.task_journal.empty() ? resolved->run_folder / "journal.jsonl" : options.task_journal);
    if (!journal) return Forward(journal);
    impl->journal = *std::move(journal);
  }
  return std::unique_ptr<Runner>(new Runner(std::move(impl)));
}

Expected<StageReport> Runner::Run(const StageDeclaration& stage, std::vector<ItemSpec> items,
                                  const std::string& branch) {
  const bool dry_run = impl_->options.dry_run;
  Expected<StageReport> report = impl_->options.plan ? impl_->LookUp(stage, std::move(items))
                                 : dry_run           ? StageRun(*impl_, stage, std::move(items)).PlanStage()
                                                     : impl_->Execute(stage, std::move(items));
  if (!report) return report;
  report->branch = branch;
  if (!dry_run) LogInfo(Summary(*report));
  return report;
}

const RunnerOptions& Runner::options() const { return impl_->options; }

}  // namespace mocurate
