#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddJobs(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<JobsArguments>();
  CLI::App* jobs = app.add_subcommand("jobs", "Show how the tasks of a run on Slurm do");
  jobs->add_option("run", arguments->run, "run folder of mocurate run --executor slurm")->required();
  auto* next = jobs->add_flag("--next", arguments->next,
                              "verify what the last array made, plan the next stage and submit it; jobs do this");
  auto* last = jobs->add_flag("--last", arguments->last, "do the stages after the arrays here; the last job does this")
                   ->excludes(next);
  auto* config = jobs->add_option("--config", arguments->config,
                                  "configuration of the run, for --next and --last: what they execute is never taken "
                                  "from the folder");
  jobs->add_option("--set", arguments->assignments, "its assignments, as given to mocurate run")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->needs(config);
  next->needs(config);
  last->needs(config);
  jobs->footer(
      "Reads the files of the run; asks squeue at most once a minute and sacct never.\n"
      "Examples:\n  mocurate jobs runs/kard\n  mocurate jobs runs/kard --json\n"
      "  mocurate jobs runs/kard --next --config kard   # when the job between two stages was lost");
  jobs->callback([&common, &verb, arguments] { verb = [&common, arguments] { return JobsVerb(common, *arguments); }; });
}

}  // namespace mocurate
