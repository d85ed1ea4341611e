#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddPlan(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<PlanArguments>();
  CLI::App* plan = app.add_subcommand("plan", "Cut the missing items of a stage into tasks for several machines");
  plan->add_option("config", arguments->config, "YAML file, or the name of a job, as of mocurate run");
  plan->add_option("--stage", arguments->stage,
                   "ingest, truth, proportions, fitting, level or canon; earlier ones are done")
      ->required();
  plan->add_option("-o,--output", arguments->output,
                   "run folder (default runs/NAME); the plan is plan/STAGE.json there");
  plan->add_option("--set", arguments->assignments, "override an option, e.g. --set ingest.path=DIR")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  auto* tasks = plan->add_option("--tasks", arguments->tasks, "number of tasks, at most; fewer items give fewer tasks")
                    ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  plan->add_option("--task-minutes", arguments->task_minutes,
                   "minutes of a task (default 10), by the times of items in the journals of the run; without any, 32 "
                   "items are executed first")
      ->check(CLI::Range(0.01, 1e5))
      ->excludes(tasks);
  plan->add_option(
          "--leftovers", arguments->leftovers,
          "missing items of each earlier stage that are executed here, at most (default 32); more are an error")
      ->check(CLI::Range(std::size_t{0}, std::size_t{1000000}));
  plan->add_option("--cores", arguments->cores, "cores of a task (default 1)")->check(CLI::Range(1, 1024));
  plan->add_option("-j,--jobs", arguments->jobs, "worker processes for items executed here (default: one per core)")
      ->check(CLI::Range(0, 1024));
  plan->add_flag("--replace", arguments->replace, "use the folder of another job, as of mocurate run");
  plan->footer(
      "Examples:\n  mocurate plan kard --stage ingest --tasks 8 -o runs/kard\n"
      "  mocurate run --plan runs/kard/plan/ingest.json --task 0   # ... to 7, on any machine that shares the cache\n"
      "  mocurate plan kard --stage proportions -o runs/kard       # the next stage, when all have ended\n"
      "  mocurate run kard -o runs/kard                            # in the end: takes their results from the cache");
  plan->callback([&common, &verb, arguments] { verb = [&common, arguments] { return PlanVerb(common, *arguments); }; });
}

}  // namespace mocurate
