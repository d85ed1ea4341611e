#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/interruption.h"
#include "core/pipeline/runner.h"
#include "job/job_checks.h"
#include "job/machine.h"
#include "job/run_folder.h"
#include "job/slurm_run.h"
#include "job/stage_plan.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kLook{2};         ///< between looks at the files of a run
constexpr std::chrono::seconds kLookAtMany{30};  ///< likewise, for arrays of many tasks
constexpr std::size_t kMany = 50;
constexpr std::size_t kLogLines = 5;
constexpr std::size_t kMostFailed = 20;  ///< tasks of an array whose logs are shown
constexpr double kSparing = 4.0;         ///< asked memory or time above this many times the used is worth a word

std::map<TaskState, std::size_t> CountsOf(const std::vector<TaskReport>& tasks) {
  std::map<TaskState, std::size_t> counts;
  for (const TaskReport& task : tasks) ++counts[task.state];
  return counts;
}

std::string MinutesText(double seconds) { return RoundedText(seconds / 60.0, 2) + " min"; }
std::string MegabytesText(double bytes) { return RoundedText(bytes / 1e6, 3) + " MB"; }

std::string TitleOf(const SubmittedJob& job) {
  if (job.kind == SlurmKind::kArray) return job.stage;
  return job.kind == SlurmKind::kStep ? "(next stage)" : "(last stages)";
}

/// The jobs that wait or run; what is completing has ended.
std::string ActiveIds(const std::string& queue) {
  std::string ids;
  for (const QueuedJob& job : ParseQueue(queue)) {
    if (job.state != "COMPLETING" && (" " + ids + " ").find(" " + job.id + " ") == std::string::npos)
      ids += (ids.empty() ? "" : " ") + job.id;
  }
  return ids;
}

/// The last lines of a log.
std::vector<std::string> LastLines(const fs::path& file) {
  const std::string text = ReadFile(file).value_or("");
  std::vector<std::string> lines;
  for (const std::string_view line : SplitText(text, '\n')) {
    if (!Trim(line).empty()) lines.emplace_back(Trim(line));
  }
  if (lines.size() > kLogLines) lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(kLogLines));
  return lines;
}

std::string ToFollow(const fs::path& folder) { return "mocurate jobs " + DisplayPath(folder); }

ErrorCode CodeOfExit(int exit_code) {
  switch (static_cast<ExitCode>(exit_code)) {
    case ExitCode::kTooManyFailures:
      return ErrorCode::kTooManyFailures;
    case ExitCode::kUsage:
      return ErrorCode::kUsage;
    case ExitCode::kInputUnusable:
      return ErrorCode::kInconsistent;
    case ExitCode::kMissingOnHost:
      return ErrorCode::kMissingOnHost;
    case ExitCode::kCannotWrite:
      return ErrorCode::kCannotWrite;
    case ExitCode::kInterrupted:
      return ErrorCode::kInterrupted;
    default:
      return ErrorCode::kInternal;
  }
}

/// Waits until an array has ended or, without one, the run; says what changes. Signals leave the jobs as they are.
class Follower {
 public:
  explicit Follower(const SlurmRun& run) : run_(run) {}

  /// True when the last array has ended before the run (submit_from: login).
  Expected<bool> Wait(bool for_array) {
    const Interruption interruption;
    gone_since_.reset();
    while (true) {
      if (run_.Outcome()) return false;
      const std::vector<SubmittedJob> jobs = run_.Jobs();
      const Expected<std::string> queue = run_.Queue();
      if (queue) {
        asked_in_vain_ = 0;
      } else if (++asked_in_vain_ == 1) {
        LogWarning(queue.error().Message());
      }
      const std::string active = queue ? ActiveIds(*queue) : std::string();
      const bool awaits_array = for_array && !jobs.empty() && jobs.back().kind == SlurmKind::kArray;
      std::size_t tasks = 0;
      if (!jobs.empty() && jobs.back().kind == SlurmKind::kArray) tasks = jobs.back().tasks;
      const bool last = !jobs.empty() && jobs.back().kind == SlurmKind::kLast;
      for (auto job = jobs.rbegin(); !last && job != jobs.rend(); ++job) {
        if (job->kind != SlurmKind::kArray) continue;
        tasks = job->tasks;
        // The queue may be a minute older than the array.
        auto counts = CountsOf(run_.Tasks(*job, false));
        const std::size_t running = counts[TaskState::kRunning];
        const std::size_t failed = counts[TaskState::kFailed] + counts[TaskState::kLost];
        Say(job->stage + ": " + std::to_string(counts[TaskState::kDone]) + " of " +
            Counted(static_cast<long long>(job->tasks), "task") + " done, " + std::to_string(running) + " running" +
            (failed > 0 ? ", " + std::to_string(failed) + " failed" : std::string()));
        const bool ended = counts[TaskState::kWaiting] + running == 0;
        if (awaits_array && (ended || (queue && Gone(active)))) return true;
        break;
      }
      if (last) Say("last stages: job " + jobs.back().id);
      if (!awaits_array && queue && Gone(active) && !run_.Outcome()) {
        const fs::path log = jobs.empty() ? fs::path() : run_.Log(jobs.back());
        return Fail(ErrorCode::kInterrupted, "no job of the run is queued any more, and it has not ended",
                    DisplayPath(log), "the log may say why; run the same command again to continue");
      }
      for (auto left = tasks > kMany ? kLookAtMany : kLook; left.count() > 0; --left) {
        std::this_thread::sleep_for(std::chrono::seconds(1));
        if (Interruption::Count() == 0) continue;
        const auto now = run_.Queue();
        const std::string ids = now ? ActiveIds(*now) : std::string();
        const bool none = now && ids.empty();
        return Fail(ErrorCode::kInterrupted,
                    none ? "stopped following; no job of the run is queued now"
                         : "stopped following; the jobs of the run go on",
                    DisplayPath(run_.folder()),
                    "see how they do: " + ToFollow(run_.folder()) + "; follow again: the same command" +
                        (ids.empty() ? std::string() : "; cancel: scancel " + ids));
      }
    }
  }

 private:
  void Say(const std::string& text) {
    if (text != said_) LogInfo(text);
    said_ = text;
  }

  /// Whether two answers of the queue, a minute apart, name no job of the run.
  bool Gone(const std::string& active) {
    const auto now = std::chrono::steady_clock::now();
    if (!active.empty()) gone_since_.reset();
    if (active.empty() && !gone_since_) gone_since_ = now;
    return gone_since_ && now - *gone_since_ > std::chrono::seconds(75);
  }

  const SlurmRun& run_;
  std::string said_;
  int asked_in_vain_ = 0;
  std::optional<std::chrono::steady_clock::time_point> gone_since_;
};

/// The most that any task used.
struct Use {
  double seconds = 0.0, bytes = 0.0;
};

Use UseOf(const std::vector<TaskReport>& tasks) {
  Use use;
  for (const TaskReport& task : tasks) {
    use = {std::max(use.seconds, task.seconds), std::max(use.bytes, task.memory_bytes)};
  }
  return use;
}

nlohmann::json JobJson(const SubmittedJob& job, const std::vector<TaskReport>& tasks) {
  nlohmann::json value = {{"job", job.id}, {"stage", TitleOf(job)}, {"cores", job.cores}};
  if (job.time_s) value["asked_s"] = *job.time_s;
  if (job.memory_bytes) value["asked_bytes"] = *job.memory_bytes;
  if (job.kind != SlurmKind::kArray) return value;
  auto counts = CountsOf(tasks);
  const Use use = UseOf(tasks);
  value.update({{"tasks", job.tasks},
                {"items", job.items},
                {"waiting", counts[TaskState::kWaiting]},
                {"running", counts[TaskState::kRunning]},
                {"done", counts[TaskState::kDone]},
                {"failed", counts[TaskState::kFailed]},
                {"lost", counts[TaskState::kLost]},
                {"used_s", use.seconds},
                {"used_bytes", use.bytes}});
  return value;
}

/// What a stage's tasks used, and how many of them there should be.
void PrintUse(const SlurmRun& run, const SubmittedJob& job, const std::vector<TaskReport>& tasks, double wished_s,
              Use& most) {
  const Use use = UseOf(tasks);
  double whole = 0.0;
  std::size_t measured = 0;
  for (const TaskReport& task : tasks) {
    whole += task.seconds;
    measured += task.seconds > 0.0 ? 1 : 0;
  }
  if (measured > 0) {
    Print("  %s: asked %s, %s; used at most %s, %s\n", job.stage.c_str(),
          job.time_s ? MinutesText(*job.time_s).c_str() : "no time",
          job.memory_bytes ? MegabytesText(*job.memory_bytes).c_str() : "no memory", MinutesText(use.seconds).c_str(),
          MegabytesText(use.bytes).c_str());
    const auto fitting = static_cast<std::size_t>(std::max(1.0, std::ceil(whole / wished_s)));
    if (measured == tasks.size() && job.tasks > 1 && (fitting * 2 < job.tasks || fitting > job.tasks * 2))
      Print("    tasks of %s would be %zu, not %zu\n", MinutesText(wished_s).c_str(), fitting, job.tasks);
    most = {std::max(most.seconds, use.seconds), std::max(most.bytes, use.bytes)};
  }
  std::size_t failed = 0;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (tasks[k].state != TaskState::kFailed && tasks[k].state != TaskState::kLost) continue;
    if (++failed > kMostFailed) continue;
    Print("  task %zu of %s %s%s\n    %s\n", k, job.stage.c_str(),
          tasks[k].state == TaskState::kLost ? "ended without a word"
                                             : ("ended with exit code " + std::to_string(tasks[k].exit_code)).c_str(),
          tasks[k].message.empty() ? "" : (": " + tasks[k].message).c_str(), DisplayPath(run.Log(job, k)).c_str());
    for (const std::string& line : LastLines(run.Log(job, k))) Print("      | %s\n", line.c_str());
  }
  if (failed > kMostFailed)
    Print("  and %zu more tasks of %s failed or were lost\n", failed - kMostFailed, job.stage.c_str());
}

/// What to ask for instead.
void PrintSuggestions(const std::optional<double>& memory_bytes, const std::optional<double>& time_s, const Use& most) {
  if (most.bytes > 0.0 && (!memory_bytes || *memory_bytes > kSparing * most.bytes))
    Print("  --set slurm.memory='%s' would do\n", MegabytesText(2.0 * most.bytes).c_str());
  if (most.seconds > 0.0 && time_s && *time_s > kSparing * most.seconds + 1800.0)
    Print("  --set slurm.time='%s' would do\n", MinutesText(2.0 * most.seconds + 600.0).c_str());
}

Status ShowJobs(CommonArguments& common, const SlurmRun& run) {
  const std::vector<SubmittedJob> jobs = run.Jobs();
  const Expected<std::string> queue = run.Queue();
  if (!queue) LogWarning(queue.error().Message());
  const std::optional<SlurmOutcome> outcome = run.Outcome();
  const std::string active = queue && !outcome ? ActiveIds(*queue) : std::string();
  nlohmann::json shown = nlohmann::json::array();
  if (!common.json)
    Print("%-14s %10s %7s %7s %7s %8s %8s %7s\n", "stage", "job", "items", "tasks", "done", "running", "waiting",
          "failed");
  const auto tasks_of = [&](const SubmittedJob& job) {
    if (job.kind != SlurmKind::kArray) return std::vector<TaskReport>();
    // The last array may have tasks that wait.
    return run.Tasks(job, outcome || (&job != &jobs.back() && &job != &jobs[jobs.size() - 2]));
  };
  for (const SubmittedJob& job : jobs) {
    const std::vector<TaskReport> tasks = tasks_of(job);
    if (common.json) {
      shown.push_back(JobJson(job, tasks));
      continue;
    }
    if (job.kind == SlurmKind::kArray) {
      auto counts = CountsOf(tasks);
      Print("%-14s %10s %7zu %7zu %7zu %8zu %8zu %7zu\n", job.stage.c_str(), job.id.c_str(), job.items, job.tasks,
            counts[TaskState::kDone], counts[TaskState::kRunning], counts[TaskState::kWaiting],
            counts[TaskState::kFailed] + counts[TaskState::kLost]);
    } else if (&job == &jobs.back()) {
      Print("%-14s %10s\n", TitleOf(job).c_str(), job.id.c_str());
    }
  }
  nlohmann::json value = {{"run", DisplayPath(run.folder())}, {"jobs", shown}, {"queued", nullptr}};
  if (queue) value["queued"] = active;
  if (outcome) value["outcome"] = {{"exit_code", outcome->exit_code}, {"message", outcome->message}};
  if (!AnswersInText(common, value)) return {};
  Use most;
  std::optional<double> memory_bytes, time_s;  // as the last array asked
  for (const SubmittedJob& job : jobs) {
    if (job.kind != SlurmKind::kArray) continue;
    PrintUse(run, job, tasks_of(job), run.settings().task_time_s, most);
    memory_bytes = job.memory_bytes;
    time_s = job.time_s;
  }
  PrintSuggestions(memory_bytes, time_s, most);
  if (queue && !outcome) {
    std::map<std::string, std::size_t> reasons;
    for (const QueuedJob& job : ParseQueue(*queue)) {
      if (job.state == "PENDING" && job.reason != "None" && job.reason != "Dependency") ++reasons[job.reason];
    }
    for (const auto& [reason, count] : reasons) Print("  %zu waiting for: %s\n", count, reason.c_str());
  }
  if (outcome) {
    Print("the run has ended%s\n", outcome->exit_code == 0 ? "" : (": " + outcome->message).c_str());
  } else if (!active.empty()) {
    Print("queued: %s; to cancel: scancel %s\n", active.c_str(), active.c_str());
  } else if (queue) {
    Print("no job is queued; to go on: mocurate run with the same arguments\n");
  }
  if (!jobs.empty() && !outcome && jobs.back().kind != SlurmKind::kArray) {
    for (const std::string& line : LastLines(run.Log(jobs.back()))) Print("  | %s\n", line.c_str());
  }
  return {};
}

/// What the jobs of a run execute: it comes from the command line and from the configuration that this names.
SlurmCommand CommandOf(const fs::path& config, const std::vector<std::string>& assignments, const JobOptions& options) {
  std::error_code problem;
  SlurmCommand command;
  command.config = (fs::is_regular_file(config, problem) ? fs::absolute(config) : config).native();
  command.assignments = assignments;
  command.working_folder = fs::current_path(problem);
  command.program = options.slurm.program;
  if (command.program.empty()) command.program = ShellQuoted(fs::read_symlink("/proc/self/exe", problem).native());
  return command;
}

/// What the last job does: the whole run, with what the arrays made in the cache.
Status RunLast(CommonArguments& common, const JobsArguments& jobs, const SlurmRun& run, int cores) {
  RunArguments arguments;
  arguments.config = jobs.config;
  arguments.output = run.folder();
  arguments.assignments = jobs.assignments;
  arguments.to = run.settings().to;
  arguments.budget = run.settings().budget;
  arguments.replace = run.settings().replace;
  arguments.executor = "local";
  arguments.jobs = cores;
  const Status done = RunVerb(common, arguments);
  std::fflush(stdout);  // who follows reads the log as soon as the run has ended
  return run.End(done);
}

}  // namespace

Status SlurmRunVerb(CommonArguments& common, const RunArguments& arguments, const LoadedJob& started) {
  if (!started.options.data.empty()) {
    return Fail(ErrorCode::kUnsupported, "a run over several sets cannot be handed to Slurm as a whole", "executor",
                "run each set with a configuration of its own");
  }
  if (const Expected<SlurmLimits> there = AskSlurmLimits(); !there) return Forward(there);
  const auto folder = RunFolder(arguments.output, started.options.name);
  if (!folder) return Forward(folder);
  if (Status ours = CheckRunFolder(*folder, started, arguments.replace); !ours) return ours;
  std::error_code problem;
  const SlurmCommand command = CommandOf(arguments.config, arguments.assignments, started.options);
  // As jobs load it, from wherever they start: paths in it are relative to its own.
  const auto reloaded = LoadJob(command.config, command.assignments, {common.allow_include});
  if (!reloaded) return Forward(reloaded);
  const LoadedJob& job = *reloaded;
  SlurmSettings settings;
  settings.to = arguments.to;
  settings.budget = arguments.budget;
  settings.replace = arguments.replace;
  settings.config_sha256 = ConfigHash(job.options);
  settings.cache = fs::absolute(DefaultCacheFolder());
  settings.task_time_s = job.options.slurm.task_time_s;

  const bool login = job.options.slurm.submit_from == SubmitFrom::kLogin;
  Expected<SlurmRun> run = SlurmRun::Open(*folder, command);
  std::string active;
  if (run) {
    fs::remove(run->folder() / "slurm" / "queue.txt", problem);  // jobs may have been cancelled since
    const Expected<std::string> queue = run->Queue();
    if (!queue) return Forward(queue);
    active = ActiveIds(*queue);
    if (!active.empty() && run->Outcome() && run->Outcome()->exit_code != 0) {
      return Fail(ErrorCode::kUsage, "the run has ended, but jobs of it are still queued: " + active,
                  DisplayPath(*folder), "wait for them, or cancel them: scancel " + active);
    }
    if (run->Outcome()) active.clear();
    if (!active.empty() &&
        (run->settings().config_sha256 != settings.config_sha256 || run->settings().to != settings.to ||
         run->settings().budget != settings.budget || run->settings().cache != settings.cache)) {
      return Fail(ErrorCode::kUsage, "jobs of this run with other arguments are queued: " + active,
                  DisplayPath(*folder), "wait for them, cancel them (scancel " + active + "), or name another folder");
    }
    if (!active.empty()) LogInfo("jobs of this run are queued, and followed: " + active);
  }
  const bool fresh = active.empty();
  if (fresh) {
    run = SlurmRun::Begin(*folder, std::move(settings), command);
    if (!run) return Forward(run);
    const Expected<SubmittedJob> first = login ? run->Next(job) : run->SubmitStep(job);
    if (!first) return run->End(Forward(first));
    LogInfo("job " + first->id + " is submitted; see how it does: " + ToFollow(run->folder()));
  }
  if (arguments.no_wait && !login) return {};
  Follower follower(*run);
  while (true) {
    const Expected<bool> array_ended = follower.Wait(login);
    if (!array_ended) return Forward(array_ended);
    if (!*array_ended) break;
    const Expected<SubmittedJob> next = run->Next(job);
    if (!next) return run->End(Forward(next));
  }
  const std::optional<SlurmOutcome> outcome = run->Outcome();
  const std::vector<SubmittedJob> jobs = run->Jobs();
  const std::string log = jobs.empty() ? std::string() : DisplayPath(run->Log(jobs.back()));
  const nlohmann::json answer = {{"run", DisplayPath(run->folder())},
                                 {"exit_code", outcome->exit_code},
                                 {"message", outcome->message},
                                 {"log", log}};
  if (AnswersInText(common, answer) && outcome->exit_code == 0) {
    for (const std::string& line : LastLines(log)) Print("%s\n", line.c_str());
  }
  if (outcome->exit_code == 0) return {};
  return Fail(CodeOfExit(outcome->exit_code), outcome->message, DisplayPath(run->folder()),
              "log: " + log + "; more: " + ToFollow(run->folder()));
}

Status JobsVerb(CommonArguments& common, const JobsArguments& arguments) {
  if (Status plain = CheckRunFiles(arguments.run); !plain) return plain;
  Expected<SlurmRun> run = SlurmRun::Open(arguments.run);
  if (!run) return Forward(run);
  if (!arguments.next && !arguments.last) return ShowJobs(common, *run);
  if (run->Outcome()) {
    return Fail(ErrorCode::kUsage, "the run has ended", DisplayPath(run->folder()),
                "to do what is missing: mocurate run with the same arguments");
  }
  if (const fs::path cache = fs::absolute(DefaultCacheFolder()); cache != run->settings().cache) {
    return Fail(ErrorCode::kInconsistent,
                "the run uses the cache " + DisplayPath(run->settings().cache) + ", here it is " + DisplayPath(cache),
                DisplayPath(run->folder()), "set MOCURATE_CACHE to the cache of the run");
  }
  const auto job = LoadJob(arguments.config, arguments.assignments, {common.allow_include});
  const auto refuse = [&run](const Status& why) {  // a person may have mistyped the command
    return std::getenv("SLURM_JOB_ID") != nullptr ? run->End(why) : why;
  };
  if (!job) return refuse(Forward(job));
  run = SlurmRun::Open(arguments.run, CommandOf(arguments.config, arguments.assignments, job->options));
  if (!run) return Forward(run);
  if (ConfigHash(job->options) != run->settings().config_sha256) {
    return refuse(Fail(ErrorCode::kInconsistent, "the configuration is not that of the run, or has changed since",
                       DisplayPath(arguments.config), "give its --set as well, or submit it again: mocurate run"));
  }
  ChooseBlasKernels();
  if (arguments.last) return RunLast(common, arguments, *run, static_cast<int>(job->options.slurm.last.cores));
  const Expected<SubmittedJob> next = run->Next(*job);
  // Another process that is at work goes on.
  if (!next && next.error().code == ErrorCode::kUsage) return Forward(next);
  if (!next) return run->End(Forward(next));
  LogInfo("submitted: " + TitleOf(*next) + ", job " + next->id);
  return {};
}

}  // namespace mocurate
