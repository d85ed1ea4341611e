#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddReproduce(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<ReproduceArguments>();
  CLI::App* reproduce =
      app.add_subcommand("reproduce", "Reproduce a table or figure of a paper, with the published numbers beside it");
  reproduce->add_option("id", arguments->id, "PAPER/ITEM, e.g. actor/table3; or `list` for all")->required();
  reproduce
      ->add_option("--data", arguments->data,
                   "NAME=PATH: your copy of a set; may be repeated (default: synthetic motions in its layout)")
      ->allow_extra_args(false);
  reproduce
      ->add_option("--profile", arguments->profile,
                   "smoke: test that it runs; small: check the order of rows; paper: as published (default small)")
      ->check(CLI::IsMember({"smoke", "small", "paper"}));
  reproduce->add_option("--time-budget", arguments->time_budget,
                        "total training time, e.g. 20min or 3h: steps are measured, then scaled");
  reproduce->add_option("-o,--output", arguments->output, "run folder (default runs/PAPER_ITEM_PROFILE)");
  reproduce->add_option("--set", arguments->assignments, "override an option of the job")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  reproduce->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")
      ->check(CLI::Range(0, 1024));
  reproduce->add_flag("-n,--dry-run", arguments->dry_run, "show what would run, run nothing");
  reproduce->add_flag("--replace", arguments->replace, "use the folder of another job, as of mocurate run");
  reproduce->footer(
      "A stopped run continues when it is started again.\n\n"
      "Examples:\n  mocurate reproduce list\n  mocurate reproduce a2m/table3\n"
      "  mocurate reproduce actor/table3 --profile smoke -o runs/table3\n"
      "  mocurate reproduce a2m/table1 --data humanact12=/data/HumanAct12 --time-budget 3h");
  reproduce->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return ReproduceVerb(common, *arguments); }; });
}

}  // namespace mocurate
