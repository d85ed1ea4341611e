#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/pipeline/runner.h"

namespace mocurate {

/// What all tasks of a plan share. A plan says what to do, never by which program or within which limits: those are
/// the stage's own and the configuration's.
struct PlanHead {
  std::string stage;
  int stage_version = 0;
  std::string program;                 ///< version of mocurate
  std::string config;                  ///< name of the run's configuration, or its absolute path
  std::string config_sha256;           ///< of the resolved configuration
  std::vector<std::string> arguments;  ///< KEY=VALUE of that configuration
  std::string blas_kernels;            ///< OpenBLAS's name for the kernels it takes where the plan was made; or empty
  std::string instructions;            ///< "avx512", "avx2" or "baseline": what a node needs
  std::filesystem::path cache;
  std::size_t items = 0;
  std::size_t tasks = 0;
};

/// The missing items of one stage, cut into tasks. JSON with the head on its first line, and a line per task, so that a
/// task parses its own items alone, however many there are.
class Plan {
 public:
  /// Writes `items`, whose inputs have their hashes; task k has the items from ends[k - 1] to ends[k]. `head.items` and
  /// `head.tasks` follow from them. Error kCannotWrite.
  static Status Write(const std::filesystem::path& file, PlanHead head, const std::vector<ItemSpec>& items,
                      const std::vector<std::size_t>& ends);

  /// Reads the head. Error kNotFound, kUnreadable, kMalformed (not a plan), kUnsupported (another version of plans).
  static Expected<Plan> Open(const std::filesystem::path& file);

  const PlanHead& head() const { return head_; }
  /// Items of task k, as the file has them: who runs them compares options and inputs with what they should be. Error
  /// kUsage beyond the last task, kMalformed.
  Expected<std::vector<ItemSpec>> Task(std::size_t task) const;

 private:
  std::filesystem::path file_;
  PlanHead head_;
};

/// Ends of tasks of about equal cost: task k has the items from ends[k - 1] to ends[k]. At most `tasks`, none empty.
std::vector<std::size_t> CutByCost(const std::vector<double>& costs, std::size_t tasks);

}  // namespace mocurate
