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
  jobs->add_flag("--last", arguments->last, "do the stages after the arrays here; the last job does this")
      ->excludes(next);
  jobs->footer(
      "Reads the files of the run; asks squeue at most once a minute and sacct never.\n"
      "Examples:\n  mocurate jobs runs/kard\n  mocurate jobs runs/kard --json\n"
      "  mocurate jobs runs/kard --next   # when the job between two stages was lost");
  jobs->callback([&common, &verb, arguments] { verb = [&common, arguments] { return JobsVerb(common, *arguments); }; });
}

}  // namespace mocurate
