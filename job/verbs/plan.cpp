#include "core/pipeline/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "canon/options.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/pipeline/content.h"
#include "core/pipeline/wire.h"
#include "fitting/options.h"
#include "ingest/options.h"
#include "job/blas_kernels.h"
#include "job/config_loading.h"
#include "job/data_sets.h"
#include "job/job_checks.h"
#include "job/main_job.h"
#include "job/run_file.h"
#include "job/run_folder.h"
#include "job/task_claim.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kPilot = 32;

/// Stages with an item per clip or person, and the stage of the job that they belong to.
struct PlannedStage {
  StageDeclaration (*declaration)();
  JobStage of;
};

const std::map<std::string, PlannedStage>& PlannedStages() {
  static const std::map<std::string, PlannedStage> stages = {
      {"ingest", {IngestDeclaration, JobStage::kIngest}},
      {"truth", {TruthDeclaration, JobStage::kIngest}},
      {"proportions", {ProportionsDeclaration, JobStage::kProportions}},
      {"fitting", {FittingDeclaration, JobStage::kFitting}},
      {"level", {LevelDeclaration, JobStage::kCanon}},
      {"canon", {CanonDeclaration, JobStage::kCanon}}};
  return stages;
}

Expected<PlannedStage> StageNamed(const std::string& name) {
  const auto found = PlannedStages().find(name);
  if (found != PlannedStages().end()) return found->second;
  std::string known;
  for (const auto& [stage, unused] : PlannedStages()) known += (known.empty() ? "" : ", ") + stage;
  return Fail(ErrorCode::kUsage, "stage '" + name + "' is not planned", "--stage",
              "stages with an item per clip are: " + known + "; mocurate run does the others");
}

std::string ConfigHash(const JobOptions& options) {
  Sha256 hasher;
  hasher.Add(CanonicalText(OptionsToJson(options)));
  return hasher.Hex();
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

std::string Minutes(double seconds) { return RoundedText(seconds / 60.0, 2) + " min"; }

}  // namespace

Status PlanVerb(CommonArguments& common, const PlanArguments& arguments) {
  ChooseBlasKernels();
  const Expected<PlannedStage> stage = StageNamed(arguments.stage);
  if (!stage) return Forward(stage);
  // As tasks load it, from wherever they start.
  std::error_code problem;
  const fs::path config =
      fs::is_regular_file(arguments.config, problem) ? fs::absolute(arguments.config) : arguments.config;
  auto job = LoadJob(config, arguments.assignments);
  if (!job) return Forward(job);
  if (!job->options.data.empty()) {
    return Fail(ErrorCode::kUnsupported, "a run over several sets is not planned as a whole",
                DisplayPath(arguments.config), "plan each set with a configuration of its own");
  }
  if (Status named = CheckNames(job->options, stage->of); !named) return named;
  const auto folder = RunFolder(arguments.output, job->options.name);
  if (!folder) return Forward(folder);
  if (Status ours = CheckRunFolder(*folder); !ours) return ours;
  RunnerOptions runner_options;
  runner_options.run_folder = *folder;
  runner_options.jobs = arguments.jobs;
  runner_options.quiet = common.quiet;
  runner_options.dry_run = true;
  runner_options.item_timeout_s = job->options.pipeline.item_timeout_s;
  if (const auto bytes = job->options.pipeline.item_memory_bytes)
    runner_options.item_memory_bytes = static_cast<std::uint64_t>(*bytes);
  const double known_seconds = MeanSeconds(*folder, arguments.stage);
  std::vector<ItemSpec> missing;
  double seconds = known_seconds;
  PlanRequest request;
  request.stage = arguments.stage;
  request.most = arguments.leftovers;
  request.pilot = arguments.tasks || known_seconds > 0.0 ? 0 : kPilot;
  bool reached = false;
  request.take = [&](const StageDeclaration&, std::vector<ItemSpec> items, double pilot) -> Status {
    reached = true;
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
  RunFile run(*job, 1.0, stage->of, *folder);
  if (Status begun = run.Begin(); !begun) return begun;
  const auto looked_up = RunMainJob(job->options, stage->of, **runner);
  const Status ended = run.End(looked_up ? Status() : Forward(looked_up));
  if (!looked_up) return Forward(looked_up);
  if (!ended) return ended;

  if (!reached) {
    return Fail(ErrorCode::kUsage, "this job has no item of stage " + arguments.stage, "--stage",
                job->options.ingest.path.empty()
                    ? "a synthetic capture is made by mocurate run --to ingest; give it as "
                      "ingest.path"
                    : "see which stages it has: mocurate run --dry-run");
  }

  const std::vector<double> costs = CostsOf(missing);
  const double whole = seconds * static_cast<double>(missing.size()) / std::max(1, arguments.cores);
  std::size_t tasks = arguments.tasks.value_or(
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(whole / (60.0 * arguments.task_minutes)))));
  const std::vector<std::size_t> ends = CutByCost(costs, tasks);
  PlanHead head;
  head.stage = stage->declaration();
  head.program = std::string(Version());
  head.config = config.native();
  head.config_sha256 = ConfigHash(job->options);
  head.arguments = arguments.assignments;
  head.blas_kernels = BlasKernels();
  head.instructions = Instructions();
  head.cache = (*runner)->options().cache_folder;
  head.item_timeout_s = runner_options.item_timeout_s;
  head.item_memory_bytes = runner_options.item_memory_bytes;
  const fs::path file = fs::absolute(*folder / "plan" / (arguments.stage + ".json"));
  for (const fs::path& needed : {file.parent_path(), head.cache}) {
    if (Status made = MakeFolder(needed); !made) return made;
  }
  if (Status written = Plan::Write(file, head, missing, ends); !written) return written;
  if (common.json) {
    common.answered = true;
    std::printf("%s\n", json({{"plan", DisplayPath(file)},
                              {"stage", arguments.stage},
                              {"items", missing.size()},
                              {"tasks", ends.size()},
                              {"seconds", whole}})
                            .dump(1)
                            .c_str());
  } else if (missing.empty()) {
    std::printf("%s: nothing is missing, no task\n", arguments.stage.c_str());
  } else if (!common.quiet) {
    const std::string each =
        whole > 0.0 ? ", about " + Minutes(whole / static_cast<double>(ends.size())) + " each" : std::string();
    std::printf("%s: %s in %s%s\nplan: %s\nrun task K of 0 to %zu:\n  mocurate run --plan %s --task K\n",
                arguments.stage.c_str(), Counted(static_cast<long long>(missing.size()), "item").c_str(),
                Counted(static_cast<long long>(ends.size()), "task").c_str(), each.c_str(), DisplayPath(file).c_str(),
                ends.size() - 1, DisplayPath(file).c_str());
  }
  return {};
}

Status TaskVerb(CommonArguments& common, const RunArguments& arguments) {
  if (!arguments.task) return Fail(ErrorCode::kUsage, "no task is named", "--plan", "add --task K, from 0");
  const Expected<Plan> plan = Plan::Open(arguments.plan);
  if (!plan) return Forward(plan);
  const PlanHead& head = plan->head();
  std::string again = "plan again: mocurate plan " + head.config + " --stage " + head.stage.name;
  for (const std::string& assignment : head.arguments) again += " --set '" + assignment + "'";
  again += " -o " + DisplayPath(fs::absolute(arguments.plan).parent_path().parent_path());
  const Expected<PlannedStage> stage = StageNamed(head.stage.name);
  if (!stage) return Forward(stage);
  if (const int version = stage->declaration().version; version != head.stage.version) {
    return Fail(ErrorCode::kInconsistent,
                "the plan is of version " + std::to_string(head.stage.version) + " of stage " + head.stage.name +
                    ", this program has version " + std::to_string(version),
                DisplayPath(arguments.plan), again);
  }
  const auto job = LoadJob(head.config, head.arguments);
  if (!job) return Forward(job);
  if (ConfigHash(job->options) != head.config_sha256) {
    return Fail(ErrorCode::kInconsistent, "the configuration has changed since the plan was made", head.config, again);
  }
  if (Status pinned = PinKernels(head.blas_kernels, head.instructions); !pinned) return pinned;
  if (std::error_code missing; !fs::is_directory(head.cache, missing)) {
    return Fail(ErrorCode::kNotFound, "the plan's cache is not there", DisplayPath(head.cache),
                "mount it there on this node, or " + again);
  }
  Expected<std::vector<ItemSpec>> items = plan->Task(*arguments.task);
  if (!items) return Forward(items);

  const fs::path folder = fs::absolute(arguments.plan).parent_path() / head.stage.name;
  const std::string name = std::to_string(*arguments.task);
  const auto claim = TaskClaim::Take(folder / (name + ".claim"));
  if (!claim) return Forward(claim);
  RunnerOptions options;
  options.run_folder = folder;
  options.task_journal = folder / (name + ".jsonl");
  options.cache_folder = head.cache;
  options.node_folder = arguments.scratch;
  options.jobs = arguments.jobs;
  options.quiet = common.quiet;
  options.item_timeout_s = head.item_timeout_s;
  options.item_memory_bytes = head.item_memory_bytes;
  auto runner = Runner::Make(options);
  if (!runner) return Forward(runner);
  const auto report = (*runner)->Run(head.stage, *std::move(items));
  if (!report) return Forward(report);
  if (common.json) {
    common.answered = true;
    std::printf("%s\n", json({{"stage", head.stage.name},
                              {"task", *arguments.task},
                              {"tasks", head.tasks},
                              {"items", report->items.size()},
                              {"done", report->done},
                              {"suspect", report->suspect},
                              {"excluded", report->excluded},
                              {"refused", report->refused},
                              {"crashed", report->crashed},
                              {"from_cache", report->from_cache},
                              {"seconds", report->seconds}})
                            .dump(1)
                            .c_str());
  }
  if (report->crashed + report->unrecorded == 0) return {};
  return Fail(ErrorCode::kTooManyFailures,
              std::to_string(report->crashed) + " of " + Counted(static_cast<long long>(report->items.size()), "item") +
                  " crashed, " + std::to_string(report->unrecorded) + " found a file missing or unreadable",
              DisplayPath(options.task_journal),
              "the journal has the reasons; make the files visible on this node and run the task again");
}

}  // namespace mocurate
