#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// The few commands of Slurm that runs need. Texts as Slurm 22.05 prints them (tests/data/slurm).

struct SlurmLimits {
  std::size_t array_size = 1001;  ///< MaxArraySize: an index is smaller
  std::size_t jobs = 10000;       ///< MaxJobCount: jobs of all users in the controller's memory
};

/// From `scontrol show config`; values that are not there stay as they are.
SlurmLimits ParseSlurmLimits(std::string_view text);

/// A line of squeue -h -r -o "%i|%T|%M|%N|%r": a job, or a task of an array.
struct QueuedJob {
  std::string id;     ///< without the task
  std::string state;  ///< PENDING, RUNNING, ...
  std::string reason;
};
std::vector<QueuedJob> ParseQueue(std::string_view text);

/// What sbatch answers with --parsable: the number of the job. Errors kConfig name the option of the group `slurm` that
/// the cluster refuses; kMissingOnHost: the controller does not answer, or refuses for another reason.
Expected<std::string> ParseSubmission(int exit_status, std::string_view text);

/// One word of a shell.
std::string ShellQuoted(const std::string& text);

/// "1-02:03:04", as sbatch --time takes it.
std::string SlurmTime(double seconds);

/// Error kMissingOnHost without Slurm's programs, or without an answer of its controller.
Expected<SlurmLimits> AskSlurmLimits();

/// Submits a script; `after`: the job that must have ended, whatever became of it, or empty. In a job an absent
/// controller is asked again for five minutes. Errors of ParseSubmission.
Expected<std::string> SubmitToSlurm(const std::filesystem::path& script, const std::string& after);

/// The jobs of `ids` that wait or run. Error kMissingOnHost.
Expected<std::string> AskQueue(const std::vector<std::string>& ids);

}  // namespace mocurate
