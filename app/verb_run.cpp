#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddRun(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* run = app.add_subcommand("run", "Run a job: ingest, fit, canonicalise, assemble, train, score, report");
  auto* config = run->add_option(
      "config", arguments->config,
      "YAML file, or the name of a job of configs (kard, reannotate/kard); a job precedes a file of that name "
      "(./NAME). Default: the embedded synthetic capture");
  auto* output = run->add_option("-o,--output", arguments->output, "run folder (default runs/NAME)");
  auto* set = run->add_option("--set", arguments->assignments, "override an option, e.g. --set ingest.path=DIR")
                  ->type_name("KEY=VALUE")
                  ->allow_extra_args(false);
  auto* to = run->add_option("--to", arguments->to,
                             "last stage: ingest proportions fitting canon assemble audit train table report");
  run->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")->check(CLI::Range(0, 1024));
  auto* budget =
      run->add_option("--budget", arguments->budget, "train the generator this many times longer than the config says")
          ->check(CLI::Range(0.001, 1e6));
  auto* data = run->add_option("--data", arguments->data,
                               "NAME=PATH: your copy of a set, in a run over several; may be repeated")
                   ->allow_extra_args(false);
  auto* dry_run =
      run->add_flag("-n,--dry-run", arguments->dry_run, "show what would run and what the cache has, run nothing");
  auto* executor = run->add_option("--executor", arguments->executor,
                                   "local, or slurm: stages with an item per clip are arrays of Slurm (the config's "
                                   "`executor`; options of the jobs: its group `slurm`)")
                       ->check(CLI::IsMember({"local", "slurm"}));
  auto* no_wait = run->add_flag("--no-wait", arguments->no_wait,
                                "with Slurm: end when the first job is submitted; see mocurate jobs");
  auto* replace = run->add_flag("--replace", arguments->replace,
                                "use the folder of another job or configuration file; its outputs stay, marked as "
                                "stale, until this job writes its own");
  auto* plan = run->add_option("--plan", arguments->plan, "run one task of a plan (mocurate plan) instead");
  for (CLI::Option* other : {config, output, set, to, budget, data, dry_run, executor, no_wait, replace})
    plan->excludes(other);
  run->add_option("--task", arguments->task, "which task of the plan, from 0")->needs(plan);
  run->add_option("--scratch", arguments->scratch,
                  "folder on a disk of this node for outputs until they are complete (default: in the cache)")
      ->needs(plan);
  run->footer(
      "Examples:\n  mocurate run\n  mocurate run kard -o runs/kard\n"
      "  mocurate run kard --set ingest.path=/data/my_kinect --to assemble\n  mocurate run my.yaml\n"
      "  mocurate run reannotate/kard --set report.videos=false   # videos can take longer than the fits\n"
      "  mocurate run kard -o /shared/runs/kard --executor slurm --set slurm.partition=short --set slurm.memory='4 "
      "GB'");
  run->callback([&common, &verb, arguments] {
    verb = [&common, arguments] {
      return arguments->plan.empty() ? RunVerb(common, *arguments) : TaskVerb(common, *arguments);
    };
  });
}

}  // namespace mocurate
