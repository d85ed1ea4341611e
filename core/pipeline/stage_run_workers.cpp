#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/stage_run.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kTick_ms = 100;
constexpr int kStartsTried = 3;
constexpr std::chrono::seconds kLongestStart{120};
/// From a batch system's warning to the end of the items in work; the warning comes 90 s before the kill.
constexpr std::chrono::seconds kLongestFarewell{60};
constexpr int kCannotExecute = 127;  // what the dynamic linker and the shell end with

fs::path OwnFolder() {
  std::error_code problem;
  return fs::read_symlink("/proc/self/exe", problem).parent_path();
}

}  // namespace

Expected<fs::path> FindWorkerProgram(const RunnerOptions& options, const std::string& name) {
  std::vector<fs::path> folders = {options.worker_folder};
  if (options.worker_folder.empty()) {
    folders = {OwnFolder(), (OwnFolder() / "../libexec/mocurate").lexically_normal()};
  }
  std::string places;
  for (const fs::path& folder : folders) {
    if (access((folder / name).c_str(), X_OK) == 0) return folder / name;
    places += (places.empty() ? "" : ", ") + DisplayPath(folder);
  }
  return Fail(ErrorCode::kMissingOnHost, "worker program '" + name + "' is missing", places,
              "build and install the part of mocurate that holds it; `mocurate doctor` lists what is installed");
}

/// A seat with a worker for every item that is ready, up to the number of jobs; then hands the items out.
void StageRun::AssignWorkers() {
  auto vacant = static_cast<std::size_t>(
      std::count_if(seats_.begin(), seats_.end(), [](const std::unique_ptr<Seat>& seat) { return !seat->task; }));
  while (!fatal_ && vacant < ready_.size() && seats_.size() < static_cast<std::size_t>(state_.options.jobs)) {
    StartWorker();
    vacant += 1;
  }
  for (std::unique_ptr<Seat>& seat : seats_) {
    if (ready_.empty() || fatal_) return;
    if (!seat->said_hello || seat->task) continue;
    Task task = std::move(ready_.front());
    ready_.pop_front();
    Dispatch(*seat, std::move(task));
  }
}

/// Takes a worker left over from an earlier stage or starts one. Those of other programs are dismissed: they hold
/// memory.
void StageRun::StartWorker() {
  if (program_.empty()) {
    const Expected<fs::path> program = FindWorkerProgram(state_.options, stage_.worker);
    if (!program) return GiveUp(program.error());
    program_ = *program;
    const auto other = [&](const std::unique_ptr<WorkerProcess>& worker) { return worker->program() != program_; };
    for (const auto& worker : state_.idle) {
      if (other(worker)) worker->CloseStdin();
    }
    state_.idle.erase(std::remove_if(state_.idle.begin(), state_.idle.end(), other), state_.idle.end());
  }
  auto seat = std::make_unique<Seat>();
  seat->start = Clock::now();
  if (!state_.idle.empty()) {
    seat->worker = std::move(state_.idle.back());
    seat->said_hello = true;
    state_.idle.pop_back();
  } else {
    Expected<std::unique_ptr<WorkerProcess>> worker = WorkerProcess::Start(program_);
    if (!worker) return GiveUp(worker.error());
    seat->worker = *std::move(worker);
  }
  seats_.push_back(std::move(seat));
}

void StageRun::WaitForWorkers() {
  std::vector<pollfd> polls;
  for (const std::unique_ptr<Seat>& seat : seats_) seat->worker->AddPolls(polls);
  const bool more = !fatal_ && next_ < items_.size() && ready_.size() < static_cast<std::size_t>(state_.options.jobs);
  poll(polls.data(), polls.size(), more ? 0 : kTick_ms);
  for (std::unique_ptr<Seat>& seat : seats_) Serve(*seat);
  seats_.erase(std::remove_if(seats_.begin(), seats_.end(),
                              [](const std::unique_ptr<Seat>& seat) { return seat->worker == nullptr; }),
               seats_.end());
}

void StageRun::Serve(Seat& seat) {
  CheckLimits(seat);
  if (!seat.verdict.empty()) return Lost(seat);  // an answer that came meanwhile does not save it: the worker is killed
  seat.worker->Pump();
  Forward(*seat.worker);
  while (true) {
    Expected<std::optional<json>> message = seat.worker->Receive();
    if (!message) {
      seat.verdict = "answered with bytes that are not a message";
      seat.worker->Signal(SIGKILL);
      return Lost(seat);
    }
    if (!message->has_value()) break;
    Answer(seat, **message);
  }
  if (seat.worker->ended()) Lost(seat);
}

/// Lines that workers write to stderr are ours too, unless the run is quiet: an error also comes as a message.
void StageRun::Forward(WorkerProcess& worker) {
  std::string text;
  for (const std::string& line : worker.TakeLines()) text += line + "\n";
  if (text.empty() || state_.options.quiet) return;
  progress_.Clear();
  PrintError(text);
}

void StageRun::Answer(Seat& seat, const json& message) {
  if (message.contains("hello")) return OnHello(seat, message["hello"]);
  if (message.contains("progress") && message["progress"].is_number()) {
    if (!seat.task) return;
    return progress_.Detail(items_[seat.task->index].item, message["progress"].get<double>(),
                            message.value("text", ""));
  }
  if (!seat.task) return;
  if (message.contains("fatal")) {
    const Expected<Error> error = ErrorFromJson(message["fatal"]);
    if (error && error->code == ErrorCode::kInternal && !DamagedInputs(state_, items_[seat.task->index]).empty()) {
      return Finish(seat, {{OutcomeKind::kRefused, {}, *error}});
    }
    std::error_code ignored;
    fs::remove_all(seat.task->folder, ignored);
    seat.task.reset();
    return GiveUp(error ? *error : error.error());
  }
  Expected<StageOutcome> outcome = OutcomeFromJson(message.contains("outcome") ? message["outcome"] : json(nullptr));
  if (outcome) return Finish(seat, *std::move(outcome));
  Finish(seat, {{OutcomeKind::kCrashed, {}, outcome.error()}});
}

void StageRun::OnHello(Seat& seat, const json& stages) {
  seat.said_hello = true;
  failed_starts_ = 0;
  if (std::find(stages.begin(), stages.end(), json(stage_.name)) != stages.end()) return;
  GiveUp({ErrorCode::kMissingOnHost, "worker program '" + stage_.worker + "' does not know the stage " + stage_.name,
          DisplayPath(program_), "it is older than this program: build and install both together"});
}

/// The worker is dead: its item, if any, has crashed.
void StageRun::Lost(Seat& seat) {
  const std::string death = seat.worker->Reap();
  Forward(*seat.worker);
  const int status = seat.worker->exit_status();
  const std::string why = seat.verdict.empty() ? death : seat.verdict;
  if (seat.task) {
    const ErrorCode code = seat.verdict.empty() ? ErrorCode::kInternal : ErrorCode::kUnsupported;
    Finish(seat, {{OutcomeKind::kCrashed, {}, {code, "worker " + why, "stage " + stage_.name, seat.way_out}}});
  } else if (!seat.said_hello && !fatal_ && (status == kCannotExecute || ++failed_starts_ >= kStartsTried)) {
    GiveUp({ErrorCode::kMissingOnHost, "worker program '" + stage_.worker + "' does not start: " + why,
            DisplayPath(program_), "`mocurate doctor` lists what is missing"});
  }
  seat.worker.reset();
}

/// The limits of the run's options, else the stage's own.
ItemLimits StageRun::Limits() const {
  const RunnerOptions& options = state_.options;
  ItemLimits limits = stage_.limits;
  limits.time_s = options.item_timeout_s.value_or(limits.time_s * options.time_factor);
  if (options.item_memory_bytes) limits.memory_bytes = options.item_memory_bytes;
  return limits;
}

void StageRun::CheckLimits(Seat& seat) {
  if (!seat.verdict.empty()) return;
  const Clock::time_point now = Clock::now();
  const ItemLimits limits = Limits();
  if (!seat.said_hello && now - seat.start > kLongestStart) seat.verdict = "did not start within two minutes";
  if (seat.task && now - seat.task->start > std::chrono::duration<double>(limits.time_s)) {
    seat.verdict = "ran past the time limit of " + FormatDouble(limits.time_s) + " s";
    seat.way_out = "pipeline.item_timeout sets it";
  }
  if (seat.task && limits.memory_bytes && seat.worker->MemoryBytes() > *limits.memory_bytes) {
    seat.verdict = "ran past the memory limit of " + std::to_string(*limits.memory_bytes) + " bytes";
    seat.way_out = "pipeline.item_memory sets it";
  }
  if (!seat.verdict.empty()) seat.worker->Signal(SIGKILL);
}

/// First signal: finish running items (workers are notified, so that long items may save and stop). Second,
/// or a minute after a batch system's warning: stop now.
void StageRun::HandleSignals() {
  const int count = Interruption::Count();
  if (count > 0) GiveUp(Interrupted());
  if (count > 0 && Interruption::OutOfTime() && !warned_) warned_ = Clock::now();
  if (count > 1 || (warned_ && Clock::now() - *warned_ > kLongestFarewell)) abandoned_ = true;
  if (!fatal_) return;
  for (const std::unique_ptr<Seat>& seat : seats_) {
    if (abandoned_) {
      seat->worker->Signal(SIGKILL);
    } else if (seat->task) {
      seat->worker->Signal(SIGTERM);
    }
  }
}

}  // namespace mocurate
