#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "job/config_loading.h"
#include "job/slurm.h"

namespace mocurate {

/// How a run was started: RUN/slurm/run.json. Anybody may have written the folder, so that nothing in it is a command.
struct SlurmSettings {
  std::string to;  ///< last stage; empty: report
  double budget = 1.0;
  bool replace = false;  ///< the folder may be of another job
  std::string config_sha256;
  std::filesystem::path cache;
  double task_time_s = 600.0;  ///< wished length of a task
};

/// What jobs execute: the arguments of the process that submits them, written into their scripts, never into a file
/// that is read again.
struct SlurmCommand {
  std::string config;  ///< name of a job, or an absolute path
  std::vector<std::string> assignments;
  std::filesystem::path working_folder;  ///< that relative paths start from
  std::string program;                   ///< shell text
};

enum class SlurmKind {
  kArray,  ///< tasks of a stage
  kStep,   ///< between stages: verifies artifacts, plans and submits
  kLast,   ///< serves all from the cache and does the other stages
};

/// A line of RUN/slurm/jobs.jsonl.
struct SubmittedJob {
  std::string id;
  SlurmKind kind = SlurmKind::kStep;
  std::string stage;                 ///< of an array
  std::size_t tasks = 0, items = 0;  ///< of an array
  std::optional<double> time_s;      ///< asked; absent: the partition's
  std::optional<double> memory_bytes;
  int cores = 1;
};

/// How a run ended: RUN/slurm/outcome.json.
struct SlurmOutcome {
  int exit_code = 0;
  std::string message;  ///< empty when done
};

enum class TaskState { kWaiting, kRunning, kDone, kFailed, kLost };

/// A task of an array, from its journal and claim, and from the queue.
struct TaskReport {
  TaskState state = TaskState::kWaiting;
  int exit_code = 0;          ///< of a failed one
  std::string message;        ///< of a failed one
  double seconds = 0.0;       ///< from begin to end
  double memory_bytes = 0.0;  ///< its workers' largest items side by side
};

/// A run whose stages are arrays of Slurm. All its state lies in files below RUN/slurm and RUN/plan.
class SlurmRun {
 public:
  /// Starts a run, or one again: jobs of an earlier start are forgotten. Error kCannotWrite; kUsage for a folder whose
  /// name cannot stand in a script.
  static Expected<SlurmRun> Begin(const std::filesystem::path& folder, SlurmSettings settings, SlurmCommand command);
  /// `command`: of who goes on with it; none to look at it. Error kNotFound without a run, kMalformed.
  static Expected<SlurmRun> Open(const std::filesystem::path& folder, SlurmCommand command = {});

  const std::filesystem::path& folder() const { return folder_; }
  const SlurmSettings& settings() const { return settings_; }
  /// Of the last start, in the order of their submission.
  std::vector<SubmittedJob> Jobs() const;
  std::optional<SlurmOutcome> Outcome() const;
  Status End(const Status& outcome) const;

  /// The first job: a step. Error of SubmitToSlurm.
  Expected<SubmittedJob> SubmitStep(const LoadedJob& job, const std::string& after = {}) const;
  /// Verifies what the last array made, plans the next stage that lacks items and submits its array and, with
  /// `submit_from: compute`, the step after it; when none lacks any, the last job. Error kUsage while another
  /// process does the same.
  Expected<SubmittedJob> Next(const LoadedJob& job) const;

  /// The tasks of an array. `array_ended`: so that tasks which have not begun are lost.
  std::vector<TaskReport> Tasks(const SubmittedJob& array, bool array_ended) const;
  /// The queue's lines about jobs of this run; asked once a minute, by all processes together, else those of before.
  Expected<std::string> Queue() const;
  /// Where a job writes: RUN/slurm/logs.
  std::filesystem::path Log(const SubmittedJob& job, std::size_t task = 0) const;

 private:
  Expected<SubmittedJob> SubmitArray(const LoadedJob& job, const std::string& stage, std::size_t items,
                                     std::size_t tasks, double seconds, const std::filesystem::path& plan) const;
  Expected<SubmittedJob> SubmitSingle(const LoadedJob& job, SlurmKind kind, const SlurmResources& wanted,
                                      const std::string& after) const;
  Expected<SubmittedJob> Submit(SubmittedJob job, const std::string& script, const std::string& after) const;
  std::string Assigned() const;
  Status Verify(const SubmittedJob& array) const;
  void WaitForClaims() const;

  std::filesystem::path folder_;
  SlurmSettings settings_;
  SlurmCommand command_;
};

}  // namespace mocurate
