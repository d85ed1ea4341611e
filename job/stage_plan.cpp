#include "job/stage_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "canon/options.h"
#include "canon/recipes/spans_file.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/pipeline/content.h"
#include "core/pipeline/journal.h"
#include "core/pipeline/wire.h"
#include "fitting/options.h"
#include "fitting/stages.h"
#include "ingest/discover.h"
#include "ingest/options.h"
#include "ingest/stages.h"
#include "job/job_items.h"
#include "job/machine.h"
#include "job/main_job.h"
#include "job/run_file.h"
#include "job/task_claim.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<json> IngestOptionsOf(const JobOptions& options) {
  return {OptionsToJson(DeclaredOfItems(options.ingest))};
}

/// Of files beside their captures, or of the synthetic capture.
std::vector<json> TruthOptionsOf(const JobOptions& options) {
  return {OptionsToJson(DeclaredOfItems(options.ingest)), {{"synthetic", OptionsToJson(options.ingest.synthetic)}}};
}

std::vector<json> ProportionsOptionsOf(const JobOptions& options) { return {ProportionsItemOptions(options)}; }
std::vector<json> FittingOptionsOf(const JobOptions& options) { return {FittingItemOptions(options)}; }
std::vector<json> LevelOptionsOf(const JobOptions& options) { return {OptionsToJson(options.canon.level)}; }
std::vector<json> CanonOptionsOf(const JobOptions& options) { return {CanonItemOptions(options)}; }

const std::vector<std::pair<std::string, PlannedStage>>& PlannedStages() {
  static const std::vector<std::pair<std::string, PlannedStage>> stages = {
      {"ingest", {IngestDeclaration, JobStage::kIngest, IngestOptionsOf, true}},
      {"truth", {TruthDeclaration, JobStage::kIngest, TruthOptionsOf, true}},
      {"proportions", {ProportionsDeclaration, JobStage::kProportions, ProportionsOptionsOf}},
      {"fitting", {FittingDeclaration, JobStage::kFitting, FittingOptionsOf}},
      {"level", {LevelDeclaration, JobStage::kCanon, LevelOptionsOf}},
      {"canon", {CanonDeclaration, JobStage::kCanon, CanonOptionsOf}}};
  return stages;
}

/// The first option of an item that is not what the configuration says; empty: none.
std::string OtherOption(const json& item, const json& said, bool may_have_more) {
  for (const auto& [name, value] : said.items()) {
    const auto own = item.find(name);
    if (own == item.end() || *own != value) return name;
  }
  for (const auto& [name, value] : item.items()) {
    if (!may_have_more && !said.contains(name)) return name;
  }
  return {};
}

/// Hash of what a stage finds by a name; empty for other inputs.
std::string HashOfNamed(const StageInput& input) {
  if (input.role == kSkeletonRole) return SkeletonInput(input.name).sha256;
  const auto spans = input.role == kSpansRole ? BuiltInSpans(input.name) : std::nullopt;
  return spans ? Sha256Hex(std::string(*spans)) : std::string();
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
    ForEachLine(journal, [&](const json& line) {
      const auto cached = line.find("from_cache");
      if (TextField(line, "stage") != stage || cached == line.end() || *cached != false) return;
      seconds += std::max(0.0, NumberField(line, "seconds"));
      items += 1.0;
    });
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

Status CheckPlannedItems(const PlannedStage& stage, const JobOptions& options, const std::vector<ItemSpec>& items,
                         const fs::path& plan) {
  const auto refuse = [&plan](const ItemSpec& item, const std::string& what) {
    return Fail(ErrorCode::kInconsistent, what, DisplayPath(plan) + ": item " + DisplayPath(item.item),
                "plan again: mocurate plan");
  };
  const std::vector<json> said = stage.options(options);
  for (const ItemSpec& item : items) {
    const json own = item.options.Whole();
    std::string other;
    for (const json& possible : said) {
      other = OtherOption(own, possible, stage.items_have_own);
      if (other.empty()) break;
    }
    if (!other.empty())
      return refuse(item, "the plan's option '" + DisplayPath(other) + "' is not that of its configuration");
    for (const StageInput& input : item.inputs) {
      if (!input.path.empty() && input.role != kSkeletonRole) continue;
      if (const std::string now = HashOfNamed(input); now.empty() || now != input.sha256)
        return refuse(item, "'" + DisplayPath(input.name) + "' (" + DisplayPath(input.role) +
                                ") is not what it was when the plan was made");
    }
  }
  return {};
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
  LimitItems(job.options.pipeline, runner_options);
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
      for (StageInput& input : item.inputs) {
        if (!input.path.empty()) input.path = fs::absolute(input.path);
      }
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
  head.stage = made.stage;
  head.stage_version = StageNamed(made.stage)->declaration().version;
  head.program = std::string(Version());
  head.config = settings.config.native();
  head.config_sha256 = ConfigHash(job.options);
  head.arguments = settings.assignments;
  head.blas_kernels = BlasKernels();
  head.instructions = Instructions();
  head.cache = (*runner)->options().cache_folder;
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
