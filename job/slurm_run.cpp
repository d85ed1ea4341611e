#include "job/slurm_run.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <set>
#include <thread>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/pipeline/cache_layout.h"
#include "core/pipeline/content.h"
#include "core/pipeline/journal.h"
#include "core/pipeline/wire.h"
#include "job/stage_plan.h"
#include "job/task_claim.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kAttempts = 3;                      ///< arrays of a stage that complete nothing: the first and two more
constexpr double kSpare = 3.0, kSpare_s = 600.0;  ///< time asked for a task: estimate times this, and this
constexpr std::chrono::seconds kLatest{60};       ///< an artifact may appear on other nodes so late
constexpr std::chrono::seconds kClaims{180};      ///< a dead task's claim is held for half of this
constexpr std::chrono::seconds kPause{5};
constexpr std::time_t kAskEvery_s = 60;
constexpr double kMostTasks = 4000001.0;  ///< of an array: Slurm's bound of MaxArraySize
constexpr char kNoAnswer = '!';           ///< first byte of queue.txt when squeue failed; its reason follows

const char* Name(SlurmKind kind) {
  return kind == SlurmKind::kArray ? "array" : kind == SlurmKind::kStep ? "step" : "last";
}

/// A job from its line; nothing for a line of another kind. Error kMalformed.
Expected<std::optional<SubmittedJob>> JobOfLine(const json& line) {
  const auto wrong = [&line](const std::string& what) {
    return Fail(ErrorCode::kMalformed, what, line.dump(-1, ' ', true, json::error_handler_t::replace).substr(0, 200));
  };
  if (!line.contains("job")) return std::optional<SubmittedJob>();
  SubmittedJob job;
  try {
    const std::string kind = line.at("kind").get<std::string>();
    job.id = line.at("job").get<std::string>();
    job.kind = kind == "array" ? SlurmKind::kArray : kind == "last" ? SlurmKind::kLast : SlurmKind::kStep;
    job.stage = line.value("stage", "");
    const double tasks = line.value("tasks", 0.0), items = line.value("items", 0.0), cores = line.value("cores", 1.0);
    if (!(tasks >= 0.0 && tasks <= kMostTasks && items >= tasks && items < 1e15 && cores >= 0.0 && cores <= 1e6))
      return wrong("tasks, items or cores are not numbers of a job (at most " + FormatDouble(kMostTasks) + " tasks)");
    job.tasks = static_cast<std::size_t>(tasks);
    job.items = static_cast<std::size_t>(items);
    job.cores = static_cast<int>(cores);
    if (line.contains("time_s")) job.time_s = line.at("time_s").get<double>();
    if (line.contains("memory_bytes")) job.memory_bytes = line.at("memory_bytes").get<double>();
  } catch (const json::exception& exception) {
    return wrong(exception.what());
  }
  if (job.id.empty() || job.id.find_first_not_of("0123456789") != std::string::npos)
    return wrong("the number of the job is not one");
  if (const auto stage = StageNamed(job.stage); job.kind == SlurmKind::kArray && !stage)
    return wrong("the stage of the array is not planned");
  return std::optional<SubmittedJob>(std::move(job));
}

Status AddLine(const fs::path& file, json line) {
  Expected<Journal> journal = Journal::Open(file);
  if (!journal) return Forward(journal);
  return journal->Add(std::move(line));
}

/// Directives of a script, and what precedes its command. A lost node's tasks are planned again, so Slurm need not
/// requeue them: two of the same would run side by side.
std::string ScriptHead(const std::string& name, const fs::path& log, const SlurmOptions& options,
                       const SlurmResources& wanted, const std::optional<double>& time_s, const std::string& more,
                       const SlurmSettings& settings, const SlurmCommand& command) {
  std::string output = log.native();
  for (std::size_t at = 0; (at = output.find('%', at)) != std::string::npos; at += 2) output.insert(at, "%");
  output += name + (more.empty() ? "-%j.log" : "-%A_%a.log");
  std::string text = "#!/bin/bash\n#SBATCH --job-name=mocurate-" + name + "\n#SBATCH --output=\"" + output +
                     "\"\n#SBATCH --open-mode=append\n#SBATCH --no-requeue\n" + more;
  const std::string partition = wanted.partition.empty() ? options.tasks.partition : wanted.partition;
  if (!partition.empty()) text += "#SBATCH --partition=" + partition + "\n";
  if (!options.account.empty()) text += "#SBATCH --account=" + options.account + "\n";
  if (time_s) text += "#SBATCH --time=" + SlurmTime(*time_s) + "\n";
  if (wanted.memory_bytes)
    text +=
        "#SBATCH --mem=" + std::to_string(static_cast<long long>(std::ceil(*wanted.memory_bytes / 1048576.0))) + "M\n";
  text += "#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=" + std::to_string(wanted.cores) + "\n";
  for (const std::string& option : options.sbatch) text += "#SBATCH " + option + "\n";
  text += "export MOCURATE_CACHE=" + ShellQuoted(settings.cache.native()) + "\n";
  text += "cd " + ShellQuoted(command.working_folder.native()) + " || :\n";
  for (const std::string& line : options.prologue) text += line + "\n";
  return text;
}

/// For the commands of scripts, which load the configuration again.
const char* AllowedIncludes(const LoadedJob& job) { return job.options.allow_include ? " --allow-include" : ""; }

Expected<SlurmOutcome> OutcomeOf(const fs::path& file) {
  const Expected<json> value = ReadJson(file);
  if (!value) return Forward(value);
  return GuardJson(DisplayPath(file), [&value] {
    return SlurmOutcome{value->at("exit_code").get<int>(), value->at("message").get<std::string>()};
  });
}

bool WhollyThere(const Cache::Entry& entry) {
  if (entry.artifact.empty()) return true;
  const Expected<Content> content = ContentOf(entry.artifact);
  return content && content->sha256 == entry.sha256;
}

double SecondsOf(const json& line) {
  std::tm parts{};
  const std::string text = TextField(line, "time");
  int year = 0, month = 0, day = 0, hour = 0, minute = 0;
  double second = 0.0;
  if (std::sscanf(text.c_str(), "%d-%d-%dT%d:%d:%lf", &year, &month, &day, &hour, &minute, &second) != 6) return 0.0;
  parts.tm_year = year - 1900;
  parts.tm_mon = month - 1;
  parts.tm_mday = day;
  parts.tm_hour = hour;
  parts.tm_min = minute;
  return static_cast<double>(timegm(&parts)) + second;
}

}  // namespace

Expected<SlurmRun> SlurmRun::Begin(const fs::path& folder, SlurmSettings settings, SlurmCommand command) {
  SlurmRun run;
  std::error_code problem;
  run.folder_ = fs::absolute(folder, problem);
  run.settings_ = std::move(settings);
  run.command_ = std::move(command);
  // Slurm reads the log's name line by line, between quotes.
  for (const char c : run.folder_.native()) {
    if (c != '"' && c != '\\' && static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) continue;
    return Fail(ErrorCode::kUsage,
                "a script of Slurm cannot hold the name of the folder: it has a line end, a quote, a "
                "backslash or another control character",
                DisplayPath(run.folder_), "name another folder with -o");
  }
  const fs::path own = run.folder_ / "slurm";
  if (Status made = MakeFolder(own / "logs"); !made) return Forward(made);
  fs::remove(own / "outcome.json", problem);
  fs::remove(own / "queue.txt", problem);
  const SlurmSettings& kept = run.settings_;
  const json value = {{"to", kept.to},
                      {"budget", kept.budget},
                      {"replace", kept.replace},
                      {"config_sha256", kept.config_sha256},
                      {"cache", kept.cache.native()},
                      {"task_time_s", kept.task_time_s}};
  if (Status written = WriteFile(own / "run.json", value.dump(1) + "\n"); !written) return Forward(written);
  if (Status noted = AddLine(own / "jobs.jsonl", {{"kind", "start"}}); !noted) return Forward(noted);
  return run;
}

Expected<SlurmRun> SlurmRun::Open(const fs::path& folder, SlurmCommand command) {
  SlurmRun run;
  run.command_ = std::move(command);
  std::error_code problem;
  run.folder_ = fs::absolute(folder, problem);
  const fs::path file = run.folder_ / "slurm" / "run.json";
  if (!fs::exists(file, problem)) {
    return Fail(ErrorCode::kNotFound, "this is no run on Slurm", DisplayPath(folder),
                "start one: mocurate run CONFIG --executor slurm -o " + DisplayPath(folder));
  }
  const Expected<json> text = ReadJson(file);
  if (!text) return Forward(text);
  const json& value = *text;
  try {
    SlurmSettings& settings = run.settings_;
    settings.to = value.at("to").get<std::string>();
    settings.budget = value.at("budget").get<double>();
    settings.replace = value.value("replace", false);  // earlier versions did not write it
    settings.config_sha256 = value.at("config_sha256").get<std::string>();
    settings.cache = value.at("cache").get<std::string>();
    settings.task_time_s = value.value("task_time_s", settings.task_time_s);  // earlier versions did not write it
  } catch (const json::exception& wrong) {
    return Fail(ErrorCode::kMalformed, wrong.what(), DisplayPath(file), "start the run again: mocurate run");
  }
  const fs::path jobs = run.folder_ / "slurm" / "jobs.jsonl";
  Status read;
  double tasks = 0.0;
  ForEachLine(jobs, [&](const json& line) {
    const auto job = JobOfLine(line);
    if (!job && read) read = Forward(job);
    if (job && *job) tasks += static_cast<double>((*job)->tasks);
  });
  if (read && tasks > kMostTasks) {
    read =
        Fail(ErrorCode::kMalformed, FormatDouble(tasks) + " tasks, at most " + FormatDouble(kMostTasks), "its lines");
  }
  const fs::path outcome = run.folder_ / "slurm" / "outcome.json";
  if (const auto ended = fs::exists(outcome, problem) ? OutcomeOf(outcome) : SlurmOutcome(); !ended)
    return Forward(ended);
  if (read) return run;
  Error error = read.error();
  error.where = DisplayPath(jobs) + ": " + error.where;
  error.hint = "start the run again: mocurate run";
  return tl::unexpected<Error>(error);
}

std::vector<SubmittedJob> SlurmRun::Jobs() const {
  std::vector<SubmittedJob> jobs;
  ForEachLine(folder_ / "slurm" / "jobs.jsonl", [&jobs](const json& line) {
    if (TextField(line, "kind") == "start") jobs.clear();
    auto job = JobOfLine(line);
    if (job && *job) jobs.push_back(**std::move(job));
  });
  return jobs;
}

std::optional<SlurmOutcome> SlurmRun::Outcome() const {
  const Expected<SlurmOutcome> outcome = OutcomeOf(folder_ / "slurm" / "outcome.json");
  return outcome ? std::optional<SlurmOutcome>(*outcome) : std::nullopt;
}

Status SlurmRun::End(const Status& outcome) const {
  const ExitCode code = outcome ? ExitCode::kDone : ExitCodeOf(outcome.error().code);
  const json value = {{"exit_code", static_cast<int>(code)},
                      {"message", outcome ? std::string() : outcome.error().Message()}};
  const Status written = WriteFile(folder_ / "slurm" / "outcome.json", value.dump(1) + "\n");
  return outcome ? written : outcome;
}

fs::path SlurmRun::Log(const SubmittedJob& job, std::size_t task) const {
  const fs::path logs = folder_ / "slurm" / "logs";
  if (job.kind == SlurmKind::kArray) return logs / (job.stage + "-" + job.id + "_" + std::to_string(task) + ".log");
  return logs / (std::string(Name(job.kind)) + "-" + job.id + ".log");
}

/// The command's assignments as words of a shell.
std::string SlurmRun::Assigned() const {
  std::string words;
  for (const std::string& assignment : command_.assignments) words += " --set " + ShellQuoted(assignment);
  return words;
}

/// Writes the script, submits it and notes the job.
Expected<SubmittedJob> SlurmRun::Submit(SubmittedJob job, const std::string& script, const std::string& after) const {
  const std::string name = job.kind == SlurmKind::kArray ? job.stage : Name(job.kind);
  const fs::path file = folder_ / "slurm" / (name + ".sh");
  if (Status written = WriteFile(file, script); !written) return Forward(written);
  Expected<std::string> id = SubmitToSlurm(file, after);
  if (!id) return Forward(id);
  job.id = *std::move(id);
  json line = {{"kind", Name(job.kind)}, {"job", job.id}, {"cores", job.cores}};
  if (job.kind == SlurmKind::kArray) {
    line["stage"] = job.stage;
    line["tasks"] = job.tasks;
    line["items"] = job.items;
  }
  if (job.time_s) line["time_s"] = *job.time_s;
  if (job.memory_bytes) line["memory_bytes"] = *job.memory_bytes;
  if (Status noted = AddLine(folder_ / "slurm" / "jobs.jsonl", std::move(line)); !noted) return Forward(noted);
  std::error_code none;
  fs::remove(folder_ / "slurm" / "queue.txt", none);  // it does not know this job
  return job;
}

Expected<SubmittedJob> SlurmRun::SubmitStep(const LoadedJob& job, const std::string& after) const {
  return SubmitSingle(job, SlurmKind::kStep, job.options.slurm.step, after);
}

Expected<SubmittedJob> SlurmRun::SubmitSingle(const LoadedJob& job, SlurmKind kind, const SlurmResources& wanted,
                                              const std::string& after) const {
  SubmittedJob single;
  single.kind = kind;
  single.time_s = wanted.time_s;
  single.memory_bytes = wanted.memory_bytes;
  single.cores = static_cast<int>(wanted.cores);
  const std::string script = ScriptHead(Name(kind), folder_ / "slurm" / "logs/", job.options.slurm, wanted,
                                        single.time_s, "", settings_, command_) +
                             "exec " + command_.program + " jobs " + ShellQuoted(folder_.native()) +
                             (kind == SlurmKind::kStep ? " --next" : " --last") + " --config " +
                             ShellQuoted(command_.config) + Assigned() + AllowedIncludes(job) + "\n";
  Expected<SubmittedJob> submitted = Submit(std::move(single), script, after);
  if (submitted) return submitted;
  Error error = submitted.error();
  const std::set<std::string> own = {"slurm.memory", "slurm.time", "slurm.cores"};
  if (own.count(error.where) > 0 || (error.where == "slurm.partition" && !wanted.partition.empty()))
    error.where.insert(std::string("slurm.").size(), std::string(Name(kind)) + ".");
  return tl::unexpected<Error>(error);
}

Expected<SubmittedJob> SlurmRun::SubmitArray(const LoadedJob& job, const std::string& stage, std::size_t items,
                                             std::size_t tasks, double seconds, const fs::path& plan) const {
  const SlurmOptions& options = job.options.slurm;
  SubmittedJob array;
  array.kind = SlurmKind::kArray;
  array.stage = stage;
  array.tasks = tasks;
  array.items = items;
  array.time_s = options.tasks.time_s;
  if (!array.time_s && seconds > 0.0)
    array.time_s = 60.0 * std::ceil((kSpare * seconds / static_cast<double>(tasks) + kSpare_s) / 60.0);
  array.memory_bytes = options.tasks.memory_bytes;
  array.cores = static_cast<int>(options.tasks.cores);
  const std::string cap = options.at_once > 0 ? "%" + std::to_string(options.at_once) : std::string();
  const std::string more = "#SBATCH --array=0-" + std::to_string(tasks - 1) + cap + "\n#SBATCH --signal=B:USR1@90\n";
  std::string script =
      ScriptHead(stage, folder_ / "slurm" / "logs/", options, options.tasks, array.time_s, more, settings_, command_) +
      "exec " + command_.program + " run --plan " + ShellQuoted(plan.native()) +
      " --task \"$SLURM_ARRAY_TASK_ID\" --jobs " + std::to_string(array.cores) + AllowedIncludes(job);
  if (!options.scratch.empty()) script += " --scratch \"" + options.scratch + "\"";
  return Submit(std::move(array), script + "\n", "");
}

/// Opens and hashes what an array made. What is not seen or not whole is looked at again for a minute; then it counts
/// as missing.
Status SlurmRun::Verify(const SubmittedJob& array) const {
  const Expected<Plan> plan = Plan::Open(folder_ / "plan" / (array.stage + ".json"));
  if (!plan) return Forward(plan);
  const StageDeclaration stage = StageNamed(array.stage)->declaration();
  if (plan->head().stage != stage.name || plan->head().stage_version != stage.version) return {};  // planned again
  const Cache cache(settings_.cache);
  const std::vector<TaskReport> tasks = Tasks(array, false);
  std::vector<std::string> doubtful;  // keys
  const auto whole = [&cache](const std::string& key) {
    const std::optional<Cache::Entry> entry = cache.Find(key);
    return entry && WhollyThere(*entry);
  };
  for (std::size_t k = 0; k < plan->head().tasks && k < tasks.size(); ++k) {
    const Expected<std::vector<ItemSpec>> items = plan->Task(k);
    if (!items) return Forward(items);
    for (const ItemSpec& item : *items) {
      std::string key = Cache::Key(stage, item);
      const bool expected = tasks[k].state == TaskState::kDone || cache.Find(key);
      if (expected && !whole(key)) doubtful.push_back(std::move(key));
    }
  }
  const auto begin = std::chrono::steady_clock::now();
  while (!doubtful.empty() && std::chrono::steady_clock::now() - begin < kLatest) {
    std::this_thread::sleep_for(kPause);
    std::vector<std::string> left;
    for (std::string& key : doubtful) {
      // Listing a folder makes this node ask the file server again.
      std::error_code none;
      for (fs::directory_iterator it(RecordPath(settings_.cache, key).parent_path(), none), end; !none && it != end;)
        it.increment(none);
      if (!whole(key)) left.push_back(std::move(key));
    }
    doubtful = std::move(left);
  }
  for (const std::string& key : doubtful) {
    const std::optional<Cache::Entry> entry = cache.Find(key);
    if (!entry) continue;
    LogWarning("cache: " + DisplayPath(entry->artifact) + " does not hold the bytes that were recorded: made again");
    DropObject(settings_.cache, entry->artifact);
  }
  return {};
}

/// A dead task's claim is held for a while.
void SlurmRun::WaitForClaims() const {
  const auto begin = std::chrono::steady_clock::now();
  const auto held = [this] {
    for (const std::string& stage : PlannedStageNames()) {
      std::error_code none;
      for (fs::directory_iterator it(folder_ / "plan" / stage, none), end; !none && it != end; it.increment(none)) {
        if (it->path().extension() == ".claim" && TaskClaim::Held(it->path())) return true;
      }
    }
    return false;
  };
  while (held() && std::chrono::steady_clock::now() - begin < kClaims) std::this_thread::sleep_for(kPause);
}

Expected<SubmittedJob> SlurmRun::Next(const LoadedJob& job) const {
  std::vector<SubmittedJob> arrays;
  for (SubmittedJob& submitted : Jobs()) {
    if (submitted.kind == SlurmKind::kArray) arrays.push_back(std::move(submitted));
  }
  const auto claim = TaskClaim::Take(folder_ / "slurm" / "step.claim");
  if (!claim) return Forward(claim);
  WaitForClaims();
  if (!arrays.empty()) {
    if (Status verified = Verify(arrays.back()); !verified) return Forward(verified);
  }
  // A controller that does not answer now may do so when it is asked to submit.
  const SlurmLimits limits = AskSlurmLimits().value_or(SlurmLimits());
  const SlurmOptions& options = job.options.slurm;
  PlanSettings settings;
  settings.config = command_.config;
  settings.assignments = command_.assignments;
  settings.folder = folder_;
  const auto last = JobStageFromName(settings_.to.empty() ? "report" : settings_.to);
  if (!last) return Forward(last);
  for (const std::string& name : PlannedStageNames()) {
    if (StageNamed(name)->of <= *last) settings.stages.push_back(name);
  }
  settings.task_minutes = options.task_time_s / 60.0;
  settings.pilot = static_cast<std::size_t>(options.pilot);
  // MaxJobCount bounds the jobs of all users: the rest is left to them.
  settings.most_tasks = std::max<std::size_t>(1, std::min(limits.array_size - 1, limits.jobs / 2));
  if (options.most_tasks > 0)
    settings.most_tasks = std::min(settings.most_tasks, static_cast<std::size_t>(options.most_tasks));
  settings.tolerated = job.options.tolerated_failures;
  settings.cores = static_cast<int>(options.tasks.cores);
  settings.jobs = static_cast<int>(options.step.cores);
  settings.quiet = true;
  while (true) {
    const Expected<MadePlan> plan = MakePlan(job, settings);
    if (!plan) return Forward(plan);
    if (plan->stage.empty()) return SubmitSingle(job, SlurmKind::kLast, options.last, "");
    if (plan->items == 0) continue;  // the pilot made them all
    // Arrays of the stage since one of them completed an item.
    int idle = 0;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (const SubmittedJob& array : arrays) {
      if (array.stage != plan->stage) continue;
      if (array.items < least) idle = 0;
      least = std::min(least, array.items);
      ++idle;
    }
    if (plan->items < least) idle = 0;
    if (idle >= kAttempts) {
      settings.given_up.insert(plan->stage);
      continue;
    }
    // What was left may have been ended by its time limit: each further array asks for twice as much.
    const double seconds = std::ldexp(plan->seconds, idle);
    Expected<SubmittedJob> array = SubmitArray(job, plan->stage, plan->items, plan->tasks, seconds, plan->file);
    if (!array || options.submit_from == SubmitFrom::kLogin) return array;
    const Expected<SubmittedJob> step = SubmitStep(job, array->id);
    if (step) return array;
    Error error = step.error();
    error.hint += (error.hint.empty() ? "" : "; ") + std::string("array ") + array->id +
                  " runs all the same: when it has ended, run the same command again";
    return tl::unexpected<Error>(error);
  }
}

std::vector<TaskReport> SlurmRun::Tasks(const SubmittedJob& array, bool array_ended) const {
  std::vector<TaskReport> tasks(array.tasks);
  const fs::path folder = folder_ / "plan" / array.stage;
  std::error_code none;
  std::set<std::string> journals;
  for (fs::directory_iterator it(folder, none), end; !none && it != end; it.increment(none))
    journals.insert(it->path().filename().native());
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    TaskReport& task = tasks[k];
    bool begun = false, ended = false;
    double began = 0.0, peak = 0.0;
    const std::string journal = std::to_string(k) + ".jsonl";
    const auto read = [&](const json& line) {
      if (!line.contains("task")) {
        if (begun) peak = std::max(peak, NumberField(line, "peak_memory_bytes"));
        return;
      }
      if (TextField(line, "job") != array.id) return;
      if (TextField(line, "event") == "begun") {
        begun = true;
        ended = false;
        began = SecondsOf(line);
      } else {
        ended = true;
        task.exit_code = static_cast<int>(std::clamp(NumberField(line, "exit_code"), 0.0, 255.0));
        task.message = TextField(line, "message");
        task.seconds = SecondsOf(line) - began;
        task.memory_bytes = peak * NumberField(line, "workers", 1.0);
      }
    };
    if (journals.count(journal) > 0) ForEachLine(folder / journal, read);
    const std::string name = std::to_string(k);
    if (ended) {
      task.state = task.exit_code == 0 ? TaskState::kDone : TaskState::kFailed;
    } else if (begun) {
      task.state = TaskClaim::Held(folder / (name + ".claim")) ? TaskState::kRunning : TaskState::kLost;
    } else if (array_ended) {
      task.state = TaskState::kLost;
    }
  }
  return tasks;
}

Expected<std::string> SlurmRun::Queue() const {
  const fs::path file = folder_ / "slurm" / "queue.txt";
  struct stat asked {};
  Expected<std::string> text;
  if (stat(file.c_str(), &asked) == 0 && std::time(nullptr) - asked.st_mtim.tv_sec < kAskEvery_s) {
    text = ReadFile(file);
  } else {
    std::vector<std::string> ids;
    for (const SubmittedJob& job : Jobs()) ids.push_back(job.id);
    // Earlier arrays have ended: a step follows an array.
    if (ids.size() > 4) ids.erase(ids.begin(), ids.end() - 4);
    if (!ids.empty()) text = AskQueue(ids);
    if (!text) text = kNoAnswer + text.error().what;
    if (Status written = WriteFile(file, *text); !written) return Forward(written);
  }
  // No answer is not an empty queue.
  if (text && !text->empty() && text->front() == kNoAnswer)
    return Fail(ErrorCode::kMissingOnHost, text->substr(1), "executor: slurm", "asked again in a minute");
  return text;
}

}  // namespace mocurate
