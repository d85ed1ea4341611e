#include "job/slurm.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "core/base/file.h"
#include "core/base/text.h"
#include "job/run_and_capture.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr double kSilence_s = 120.0;  ///< Slurm's own timeouts are shorter
constexpr int kMostTries = 5;
constexpr std::chrono::seconds kBetweenTries{60};

Expected<fs::path> ProgramNamed(const std::string& name) {
  const char* folders = std::getenv("PATH");
  for (const std::string_view folder : SplitText(folders != nullptr ? folders : "", ':')) {
    const fs::path program = fs::path(folder) / name;
    if (!folder.empty() && access(program.c_str(), X_OK) == 0) return program;
  }
  return Fail(ErrorCode::kMissingOnHost, "Slurm's program " + name + " is not in PATH", "executor: slurm",
              "run on a login node of the cluster, or install it (Debian: slurm-client); without Slurm: --executor "
              "local, or mocurate plan and your own engine");
}

Expected<ProgramAnswer> Ask(const std::string& name, const std::vector<std::string>& arguments) {
  const Expected<fs::path> program = ProgramNamed(name);
  if (!program) return Forward(program);
  CaptureOptions listening;
  listening.silence_s = kSilence_s;
  return RunAndCapture(*program, arguments, listening);
}

bool Contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

/// The reason of a refusal.
std::string ReasonIn(std::string_view text) {
  const std::string last = LastLine(text);
  return last.empty() ? "no answer" : last;
}

/// The controller is away or busy. It may have taken the job all the same: a task is done once, whoever calls it.
bool NoController(std::string_view text) {
  return Contains(text, "Unable to contact slurm controller") || Contains(text, "Socket timed out");
}

tl::unexpected<Error> NotAnswered(const std::string& asked, std::string_view text) {
  return Fail(ErrorCode::kMissingOnHost, asked + ": " + ReasonIn(text), "executor: slurm",
              "see whether the cluster answers: scontrol ping");
}

}  // namespace

std::string ShellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string SlurmTime(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  char text[64];
  std::snprintf(text, sizeof text, "%lld-%02lld:%02lld:%02lld", whole / 86400, whole / 3600 % 24, whole / 60 % 60,
                whole % 60);
  return text;
}

SlurmLimits ParseSlurmLimits(std::string_view text) {
  SlurmLimits limits;
  for (const std::string_view line : SplitText(text, '\n')) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view name = Trim(line.substr(0, equals));
    const auto value = ParseInteger(Trim(line.substr(equals + 1)));
    if (!value || *value < 1) continue;
    if (name == "MaxArraySize") limits.array_size = static_cast<std::size_t>(*value);
    if (name == "MaxJobCount") limits.jobs = static_cast<std::size_t>(*value);
  }
  return limits;
}

std::vector<QueuedJob> ParseQueue(std::string_view text) {
  std::vector<QueuedJob> jobs;
  for (const std::string_view line : SplitText(text, '\n')) {
    const std::vector<std::string_view> cells = SplitText(Trim(line), '|');
    if (cells.size() < 5 || cells[0].empty() || cells[0].front() < '0' || cells[0].front() > '9') continue;
    QueuedJob job;
    job.id = std::string(cells[0].substr(0, cells[0].find('_')));
    job.state = std::string(cells[1]);
    job.reason = std::string(cells[4]);
    jobs.push_back(std::move(job));
  }
  return jobs;
}

Expected<std::string> ParseSubmission(int exit_status, std::string_view text) {
  if (exit_status == 0) {
    for (const std::string_view line : SplitText(text, '\n')) {
      const std::string_view id = SplitText(Trim(line), ';').front();  // "12", or "12;cluster"
      if (ParseInteger(id)) return std::string(id);
    }
    return NotAnswered("sbatch names no job", text);
  }
  struct Refusal {
    const char* says;
    const char* option;
    const char* hint;
  };
  static const Refusal refusals[] = {
      {"nvalid partition", "slurm.partition", "sinfo lists the partitions"},
      {"nvalid account", "slurm.account", "sacctmgr show associations user=$USER lists yours"},
      {"Memory specification", "slurm.memory", "sinfo -o '%P %m' shows the memory of nodes"},
      {"job submit limit", "slurm.most_tasks",
       "your account may submit fewer jobs, or for less time (slurm.time): set it lower"},
      {"time limit", "slurm.time", "sinfo -o '%P %l' shows the limits of partitions"},
      {"nvalid --time", "slurm.time", "sinfo -o '%P %l' shows the limits of partitions"},
      {"node configuration is not available", "slurm.cores", "sinfo -o '%P %c %m' shows cores and memory of nodes"},
      {"processors requested", "slurm.cores", "sinfo -o '%P %c' shows the cores of nodes"},
      {"nvalid job array", "slurm.most_tasks", "scontrol show config | grep MaxArraySize"},
      {"SubmitJob", "slurm.most_tasks", "your account may submit fewer jobs: set it lower"},
      {"nrecognized option", "slurm.sbatch", "sbatch --help lists the options"},
  };
  for (const Refusal& refusal : refusals) {
    if (!Contains(text, refusal.says)) continue;
    return Fail(ErrorCode::kConfig, "Slurm refuses the job: " + ReasonIn(text), refusal.option, refusal.hint);
  }
  if (NoController(text)) return NotAnswered("sbatch", text);
  return Fail(ErrorCode::kMissingOnHost, "Slurm refuses the job: " + ReasonIn(text), "executor: slurm",
              "the script in the run folder's slurm/ can be submitted by hand with sbatch");
}

Expected<SlurmLimits> AskSlurmLimits() {
  if (const auto sbatch = ProgramNamed("sbatch"); !sbatch) return Forward(sbatch);
  const Expected<ProgramAnswer> answer = Ask("scontrol", {"show", "config"});
  if (!answer) return Forward(answer);
  if (answer->exit_status != 0) return NotAnswered("scontrol show config", answer->text);
  return ParseSlurmLimits(answer->text);
}

Expected<std::string> SubmitToSlurm(const fs::path& script, const std::string& after) {
  std::vector<std::string> arguments = {"--parsable"};
  if (!after.empty()) arguments.push_back("--dependency=afterany:" + after);
  arguments.push_back(script.native());
  const bool in_job = std::getenv("SLURM_JOB_ID") != nullptr;
  for (int tries = 1;; ++tries) {
    const Expected<ProgramAnswer> answer = Ask("sbatch", arguments);
    if (!answer) return Forward(answer);
    Expected<std::string> id = ParseSubmission(answer->exit_status, answer->text);
    if (id || !NoController(answer->text) || !in_job || tries == kMostTries) return id;
    std::this_thread::sleep_for(kBetweenTries);
  }
}

Expected<std::string> AskQueue(const std::vector<std::string>& ids) {
  const Expected<ProgramAnswer> answer = Ask("squeue", {"-h", "-r", "-j", JoinTexts(ids, ","), "-o", "%i|%T|%M|%N|%r"});
  if (!answer) return Forward(answer);
  // A job that has ended is forgotten after some minutes.
  if (answer->exit_status != 0 && Contains(answer->text, "Invalid job id")) return std::string();
  if (answer->exit_status != 0) return NotAnswered("squeue", answer->text);
  return answer->text;
}

}  // namespace mocurate
