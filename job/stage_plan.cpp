#include "job/stage_plan.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "canon/options.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/pipeline/content.h"
#include "core/pipeline/wire.h"
#include "fitting/options.h"
#include "ingest/options.h"
#include "job/blas_kernels.h"
#include "job/main_job.h"
#include "job/run_file.h"
#include "job/task_claim.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::vector<std::pair<std::string, PlannedStage>>& PlannedStages() {
  static const std::vector<std::pair<std::string, PlannedStage>> stages = {
      {"ingest", {IngestDeclaration, JobStage::kIngest}},
      {"truth", {TruthDeclaration, JobStage::kIngest}},
      {"proportions", {ProportionsDeclaration, JobStage::kProportions}},
      {"fitting", {FittingDeclaration, JobStage::kFitting}},
      {"level", {LevelDeclaration, JobStage::kCanon}},
      {"canon", {CanonDeclaration, JobStage::kCanon}}};
  return stages;
}

/// Seconds of executed items of a stage, mean over the journals of a run and of its tasks; 0 without any.
double MeanSeconds(const fs::path& folder, const std::string& stage) {
  std::vector<fs::path> journals = {folder / "journal.jsonl"};
  std::error_code missing;
  for (fs::directory_iterator it(folder / "plan" / stage, missing), end; !missing && it != end; it.increment(missing)) {
    if (it->path().extension() == ".jsonl") journals.push_back(it->path());
  }
  double seconds = 0.0, items = 0.0;
  for (const fs::path& journal : journals) {
    std::ifstream lines(journal);
    for (std::string line; std::getline(lines, line);) {
      const Expected<json> entry = FromCanonicalText(line);
      if (!entry || !entry->is_object() || entry->value("stage", "") != stage || entry->value("from_cache", true))
        continue;
      seconds += entry->value("seconds", 0.0);
      items += 1.0;
    }
  }
  return items > 0.0 ? seconds / items : 0.0;
}

/// Cost of each item in units of the mean: the size of its inputs.
std::vector<double> CostsOf(const std::vector<ItemSpec>& items) {
  std::vector<double> costs;
  for (const ItemSpec& item : items) {
    double bytes = 0.0;
    for (const StageInput& input : item.inputs) bytes += static_cast<double>(BytesOf(input.path));
    costs.push_back(std::max(bytes, 1.0));
  }
  const double mean = std::accumulate(costs.begin(), costs.end(), 0.0) / std::max<double>(1.0, costs.size());
  for (double& cost : costs) cost /= mean;
  return costs;
}

/// Error kUsage while a task of the plan in this folder is at work: it would run items of another plan.
Status CheckIdle(const fs::path& folder) {
  std::error_code none;
  for (fs::directory_iterator it(folder, none), end; !none && it != end; it.increment(none)) {
    if (it->path().extension() != ".claim" || !TaskClaim::Held(it->path())) continue;
    return Fail(ErrorCode::kUsage, "a task of the present plan is at work", DisplayPath(it->path()),
                "plan again when it has ended");
  }
  return {};
}

}  // namespace

Expected<PlannedStage> StageNamed(const std::string& name) {
  std::string known;
  for (const auto& [stage, planned] : PlannedStages()) {
    if (stage == name) return planned;
    known += (known.empty() ? "" : ", ") + stage;
  }
  return Fail(ErrorCode::kUsage, "stage '" + name + "' is not planned", "--stage",
              "stages with an item per clip are: " + known + "; mocurate run does the others");
}

std::vector<std::string> PlannedStageNames() {
  std::vector<std::string> names;
  for (const auto& [stage, unused] : PlannedStages()) names.push_back(stage);
  return names;
}

std::string ConfigHash(const JobOptions& options) {
  json value = OptionsToJson(options);
  for (const char* elsewhere : {"executor", "slurm"}) value.erase(elsewhere);
  Sha256 hasher;
  hasher.Add(CanonicalText(value));
  return hasher.Hex();
}

Expected<MadePlan> MakePlan(const LoadedJob& job, const PlanSettings& settings) {
  RunnerOptions runner_options;
  runner_options.run_folder = settings.folder;
  runner_options.jobs = settings.jobs;
  runner_options.quiet = settings.quiet;
  runner_options.dry_run = true;
  runner_options.item_timeout_s = job.options.pipeline.item_timeout_s;
  if (const auto bytes = job.options.pipeline.item_memory_bytes)
    runner_options.item_memory_bytes = static_cast<std::uint64_t>(*bytes);
  JobStage last = JobStage::kIngest;
  for (const std::string& name : settings.stages) {
    const Expected<PlannedStage> stage = StageNamed(name);
    if (!stage) return Forward(stage);
    last = std::max(last, stage->of);
    if (Status idle = CheckIdle(settings.folder / "plan" / name); !idle) return Forward(idle);
  }
  MadePlan made;
  std::vector<ItemSpec> missing;
  double seconds = 0.0;
  PlanRequest request;
  request.stages = settings.stages;
  request.most = settings.leftovers;
  request.given_up = settings.given_up;
  request.tolerated = settings.tolerated;
  request.pilot = [&](const std::string& stage) {
    seconds = MeanSeconds(settings.folder, stage);
    return settings.tasks || seconds > 0.0 ? 0 : settings.pilot;
  };
  request.take = [&](const StageDeclaration& stage, std::vector<ItemSpec> items, double pilot) -> Status {
    made.stage = stage.name;
    for (ItemSpec& item : items) {
      for (StageInput& input : item.inputs) input.path = fs::absolute(input.path);
    }
    std::move(items.begin(), items.end(), std::back_inserter(missing));
    if (pilot > 0.0) seconds = pilot;
    return {};
  };
  runner_options.plan = request;
  auto runner = Runner::Make(runner_options);
  if (!runner) return Forward(runner);
  RunFile run(job, 1.0, last, settings.folder);
  if (Status begun = run.Begin(); !begun) return Forward(begun);
  const auto looked_up = RunMainJob(job.options, last, **runner);
  const Status ended = run.End(looked_up ? Status() : Forward(looked_up));
  if (!looked_up) return Forward(looked_up);
  if (!ended) return Forward(ended);
  if (made.stage.empty()) return made;

  const std::vector<double> costs = CostsOf(missing);
  made.seconds = seconds * static_cast<double>(missing.size()) / std::max(1, settings.cores);
  const double wished = std::max(1.0, std::ceil(made.seconds / (60.0 * settings.task_minutes)));
  const std::size_t tasks = settings.tasks.value_or(static_cast<std::size_t>(std::min(wished, 1e9)));
  const std::vector<std::size_t> ends = CutByCost(costs, std::min(tasks, settings.most_tasks));
  PlanHead head;
  head.stage = StageNamed(made.stage)->declaration();
  head.program = std::string(Version());
  head.config = settings.config.native();
  head.config_sha256 = ConfigHash(job.options);
  head.arguments = settings.assignments;
  head.blas_kernels = BlasKernels();
  head.instructions = Instructions();
  head.cache = (*runner)->options().cache_folder;
  head.item_timeout_s = runner_options.item_timeout_s;
  head.item_memory_bytes = runner_options.item_memory_bytes;
  made.file = fs::absolute(settings.folder / "plan" / (made.stage + ".json"));
  made.items = missing.size();
  made.tasks = ends.size();
  for (const fs::path& needed : {made.file.parent_path(), head.cache}) {
    if (Status there = MakeFolder(needed); !there) return Forward(there);
  }
  if (Status written = Plan::Write(made.file, head, missing, ends); !written) return Forward(written);
  return made;
}

}  // namespace mocurate
