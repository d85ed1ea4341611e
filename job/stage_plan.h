#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/pipeline/plan.h"
#include "job/config_loading.h"
#include "job/job_stage.h"

namespace mocurate {

/// A stage with an item per clip or person, and the stage of the job that it belongs to.
struct PlannedStage {
  StageDeclaration (*declaration)();
  JobStage of;
  /// What the configuration says the options of its items are; where there are several, one of them.
  std::vector<nlohmann::json> (*options)(const JobOptions& options);
  bool items_have_own = false;  ///< beside those, from their files: a label, a place in the file
};

/// Error kUsage for another stage.
Expected<PlannedStage> StageNamed(const std::string& name);
/// Names of those stages in the order of a run.
std::vector<std::string> PlannedStageNames();

/// SHA-256 over the options that results depend on.
std::string ConfigHash(const JobOptions& options);

/// Compares items of a plan, which anybody may have written, with what the configuration says: their options, and the
/// content of inputs that a stage finds by their name. (The runner compares files.) Error kInconsistent.
Status CheckPlannedItems(const PlannedStage& stage, const JobOptions& options, const std::vector<ItemSpec>& items,
                         const std::filesystem::path& plan);

struct PlanSettings {
  std::filesystem::path config;  ///< name of a job, or an absolute path
  std::vector<std::string> assignments;
  std::filesystem::path folder;      ///< of the run
  std::vector<std::string> stages;   ///< the first that lacks items is planned
  std::optional<std::size_t> tasks;  ///< at most; absent: by `task_minutes`
  double task_minutes = 10.0;
  std::size_t most_tasks = 1000000;
  std::size_t pilot = 32;          ///< items executed at once of a stage without times in the run's journals
  std::size_t leftovers = 32;      ///< missing items of earlier stages that are executed at once, at most
  std::set<std::string> given_up;  ///< as of PlanRequest
  double tolerated = 0.0;          ///< as of PlanRequest
  int cores = 1;                   ///< of a task
  int jobs = 0;                    ///< worker processes for items executed here
  bool quiet = false;
};

struct MadePlan {
  std::string stage;  ///< empty: the job has no item of the stages, or with several none is missing
  std::size_t items = 0, tasks = 0;
  double seconds = 0.0;  ///< of all tasks together; 0: unknown
  std::filesystem::path file;
};

/// Looks a job up in the cache and writes RUN/plan/STAGE.json. Errors of Runner::Run; kUsage where a task of the
/// present plan is at work.
Expected<MadePlan> MakePlan(const LoadedJob& job, const PlanSettings& settings);

}  // namespace mocurate
