#include "core/pipeline/plan.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/journal.h"
#include "job/config_loading.h"
#include "job/job_checks.h"
#include "job/job_items.h"
#include "job/machine.h"
#include "job/run_folder.h"
#include "job/slurm.h"
#include "job/stage_plan.h"
#include "job/task_claim.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

std::string Duration(double seconds) {
  return seconds < 60.0 ? RoundedText(seconds, 2) + " s" : RoundedText(seconds / 60.0, 2) + " min";
}

/// Notes begin and end of a task in its journal, for `mocurate jobs`.
Status NoteTask(const fs::path& journal, std::size_t task, nlohmann::json event) {
  Expected<Journal> lines = Journal::Open(journal);
  if (!lines) return Forward(lines);
  event["task"] = task;
  const char* array = std::getenv("SLURM_ARRAY_JOB_ID");
  event["job"] = array != nullptr ? array : "";
  return lines->Add(std::move(event));
}

}  // namespace

Status PlanVerb(CommonArguments& common, const PlanArguments& arguments) {
  ChooseBlasKernels();
  const Expected<PlannedStage> stage = StageNamed(arguments.stage);
  if (!stage) return Forward(stage);
  // As tasks load it, from wherever they start.
  std::error_code problem;
  PlanSettings settings;
  settings.config = fs::is_regular_file(arguments.config, problem) ? fs::absolute(arguments.config) : arguments.config;
  settings.assignments = arguments.assignments;
  settings.stages = {arguments.stage};
  settings.tasks = arguments.tasks;
  settings.task_minutes = arguments.task_minutes;
  settings.leftovers = arguments.leftovers;
  settings.cores = arguments.cores;
  settings.jobs = arguments.jobs;
  settings.quiet = common.quiet;
  auto job = LoadJob(settings.config, arguments.assignments, {common.allow_include});
  if (!job) return Forward(job);
  if (!job->options.data.empty()) {
    return Fail(ErrorCode::kUnsupported, "a run over several sets is not planned as a whole",
                DisplayPath(arguments.config), "plan each set with a configuration of its own");
  }
  if (Status named = CheckNames(job->options, stage->of); !named) return named;
  const auto folder = RunFolder(arguments.output, job->options.name);
  if (!folder) return Forward(folder);
  if (Status ours = CheckRunFolder(*folder, *job, arguments.replace); !ours) return ours;
  settings.folder = *folder;
  const Expected<MadePlan> made = MakePlan(*job, settings);
  if (!made) return Forward(made);
  if (made->stage.empty()) {
    return Fail(ErrorCode::kUsage, "this job has no item of stage " + arguments.stage, "--stage",
                job->options.ingest.path.empty()
                    ? "a synthetic capture is made by mocurate run --to ingest; give it as "
                      "ingest.path"
                    : "see which stages it has: mocurate run --dry-run");
  }
  const bool in_text = AnswersInText(common, {{"plan", DisplayPath(made->file)},
                                              {"stage", made->stage},
                                              {"items", made->items},
                                              {"tasks", made->tasks},
                                              {"seconds", made->seconds}});
  if (in_text && made->items == 0) {
    Print("%s: nothing is missing, no task\n", made->stage.c_str());
  } else if (in_text) {
    const std::string each = made->seconds > 0.0
                                 ? ", about " + Duration(made->seconds / static_cast<double>(made->tasks)) + " each"
                                 : std::string();
    Print("%s: %s in %s%s\nplan: %s\nrun task K of 0 to %zu:\n  mocurate run --plan %s --task K%s\n",
          made->stage.c_str(), Counted(static_cast<long long>(made->items), "item").c_str(),
          Counted(static_cast<long long>(made->tasks), "task").c_str(), each.c_str(), DisplayPath(made->file).c_str(),
          made->tasks - 1, ShellQuoted(made->file.native()).c_str(), common.allow_include ? " --allow-include" : "");
  }
  return {};
}

Status TaskVerb(CommonArguments& common, const RunArguments& arguments) {
  if (!arguments.task) return Fail(ErrorCode::kUsage, "no task is named", "--plan", "add --task K, from 0");
  const Expected<Plan> plan = Plan::Open(arguments.plan);
  if (!plan) return Forward(plan);
  const PlanHead& head = plan->head();
  std::string again = "plan again: mocurate plan " + ShellQuoted(head.config) + " --stage " + ShellQuoted(head.stage);
  for (const std::string& assignment : head.arguments) again += " --set " + ShellQuoted(assignment);
  if (common.allow_include) again += " --allow-include";
  again += " -o " + ShellQuoted(fs::absolute(arguments.plan).parent_path().parent_path().native());
  const Expected<PlannedStage> stage = StageNamed(head.stage);
  if (!stage) {
    return Fail(ErrorCode::kInconsistent,
                "the plan is of a stage that is not planned: '" + DisplayPath(head.stage) + "'",
                DisplayPath(arguments.plan), stage.error().hint);
  }
  const StageDeclaration declaration = stage->declaration();
  if (const int version = declaration.version; version != head.stage_version) {
    return Fail(ErrorCode::kInconsistent,
                "the plan is of version " + std::to_string(head.stage_version) + " of stage " + head.stage +
                    ", this program has version " + std::to_string(version),
                DisplayPath(arguments.plan), again);
  }
  // A pipe that the plan names would be waited for.
  if (std::error_code unknown; fs::is_other(fs::status(head.config, unknown)))
    return Fail(ErrorCode::kInconsistent, "the plan's configuration is a device or a pipe", DisplayPath(head.config),
                again);
  const auto job = LoadJob(head.config, head.arguments, {common.allow_include});
  if (!job) return Forward(job);
  if (ConfigHash(job->options) != head.config_sha256) {
    return Fail(ErrorCode::kInconsistent, "the configuration has changed since the plan was made", head.config, again);
  }
  if (Status pinned = PinKernels(head.blas_kernels, head.instructions); !pinned) return pinned;
  if (const fs::path here = fs::absolute(DefaultCacheFolder()); here != head.cache) {
    return Fail(ErrorCode::kInconsistent,
                "the plan is of the cache " + DisplayPath(head.cache) + ", here it is " + DisplayPath(here),
                DisplayPath(arguments.plan), "set MOCURATE_CACHE to the cache of the run, or " + again);
  }
  if (std::error_code missing; !fs::is_directory(head.cache, missing)) {
    return Fail(ErrorCode::kNotFound, "the plan's cache is not there", DisplayPath(head.cache),
                "mount it there on this node, or " + again);
  }
  Expected<std::vector<ItemSpec>> items = plan->Task(*arguments.task);
  if (!items) return Forward(items);
  if (Status same = CheckPlannedItems(*stage, job->options, *items, arguments.plan); !same) return same;

  const fs::path folder = fs::absolute(arguments.plan).parent_path() / head.stage;
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
  LimitItems(job->options.pipeline, options);
  if (Status begun = NoteTask(options.task_journal, *arguments.task, {{"event", "begun"}}); !begun) return begun;
  const auto ended = [&](Status outcome) -> Status {
    const ExitCode code = outcome ? ExitCode::kDone : ExitCodeOf(outcome.error().code);
    const nlohmann::json event = {{"event", "ended"},
                                  {"exit_code", static_cast<int>(code)},
                                  {"workers", arguments.jobs > 0 ? arguments.jobs : AvailableCores()},
                                  {"message", outcome ? std::string() : outcome.error().Message()}};
    const Status noted = NoteTask(options.task_journal, *arguments.task, event);
    return outcome ? noted : outcome;
  };
  auto runner = Runner::Make(options);
  if (!runner) return ended(Forward(runner));
  const auto report = (*runner)->Run(declaration, *std::move(items));
  if (!report) return ended(Forward(report));
  AnswersInText(common, {{"stage", head.stage},
                         {"task", *arguments.task},
                         {"tasks", head.tasks},
                         {"items", report->items.size()},
                         {"done", report->done},
                         {"suspect", report->suspect},
                         {"excluded", report->excluded},
                         {"refused", report->refused},
                         {"crashed", report->crashed},
                         {"from_cache", report->from_cache},
                         {"seconds", report->seconds}});
  if (report->crashed + report->unrecorded == 0) return ended({});
  return ended(Fail(ErrorCode::kTooManyFailures,
                    std::to_string(report->crashed) + " of " +
                        Counted(static_cast<long long>(report->items.size()), "item") + " crashed, " +
                        std::to_string(report->unrecorded) + " found a file missing, unreadable or changed",
                    DisplayPath(options.task_journal),
                    "the journal has the reasons; make the files visible on this node and run the task again"));
}

}  // namespace mocurate
