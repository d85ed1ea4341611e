// The command lines of the verbs that draw motions and reproduce papers.

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddDraw(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<DrawArguments>();
  CLI::App* draw = app.add_subcommand("draw", "Draw motions: rows of equally spaced frames, or a video");
  draw->add_option("motions", arguments->motions,
                   "datasets, MotionSets, or files and folders of motions; NAME=PATH names the row")
      ->required();
  draw->add_option("-o,--output", arguments->output, "picture (.svg, .png) or video (.mp4) to write")->required();
  draw->add_option("--label", arguments->labels, "class that is shown; may be repeated (default: one of each class)")
      ->allow_extra_args(false);
  draw->add_option("--clip", arguments->clips, "id of a clip, or its end, in the place of --label; may be repeated")
      ->allow_extra_args(false);
  draw->add_option("--samples", arguments->samples, "motions of each label and file")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  draw->add_option("--stills", arguments->stills, "equally spaced frames of a row")
      ->check(CLI::Range(1, 60))
      ->capture_default_str();
  draw->add_option("--figure", arguments->figure, "bones, capsules around them, or the skin of a rigged body")
      ->check(CLI::IsMember({"bones", "capsules", "skin"}))
      ->capture_default_str();
  draw->add_option("--body", arguments->body,
                   "SMPL_NEUTRAL.pkl or body_cc0.h5 for --figure skin (default: below MOCURATE_WEIGHTS)");
  draw->add_option("--source", arguments->source, "source declaration, where the files do not say it");
  draw->add_option("--title", arguments->title, "above the picture");
  draw->add_option("--scale", arguments->scale, "pixels of a PNG or video for each unit of the drawing")
      ->check(CLI::Range(0.25, 8.0))
      ->capture_default_str();
  draw->add_flag("--force", arguments->force, "overwrite the output");
  draw->footer(
      "Left limbs are blue, right ones orange. Brackets below a row are the parts of a long motion; the box to the\n"
      "right shows the root's path from above.\n\n"
      "Examples:\n  mocurate draw walk.bvh -o walk.svg\n"
      "  mocurate draw Real=runs/kard/dataset.h5 ours.h5 --label kick --samples 3 -o kick.png\n"
      "  mocurate draw long.h5 --stills 24 --figure capsules -o long.svg\n"
      "  mocurate draw long.h5 -o long.mp4");
  draw->callback([&common, &verb, arguments] { verb = [&common, arguments] { return DrawVerb(common, *arguments); }; });
}

void AddReproduce(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<ReproduceArguments>();
  CLI::App* reproduce =
      app.add_subcommand("reproduce", "Run a table or figure of a paper, our numbers beside the published ones");
  reproduce->add_option("id", arguments->id, "PAPER/ITEM, e.g. actor/table3; or `list`: what there is")->required();
  reproduce
      ->add_option("--data", arguments->data,
                   "NAME=PATH: your copy of a set; may be repeated (default: synthetic motions in its layout)")
      ->allow_extra_args(false);
  reproduce
      ->add_option("--profile", arguments->profile,
                   "smoke: whether it runs; small: whether rows come in order; paper: as published (default small)")
      ->check(CLI::IsMember({"smoke", "small", "paper"}));
  reproduce->add_option("--time-budget", arguments->time_budget,
                        "train for about so long in all, e.g. 20min or 3h: steps are measured, then scaled");
  reproduce->add_option("-o,--output", arguments->output, "run folder (default runs/PAPER_ITEM_PROFILE)");
  reproduce->add_option("--set", arguments->assignments, "override an option of the job")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  reproduce->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")
      ->check(CLI::Range(0, 1024));
  reproduce->add_flag("-n,--dry-run", arguments->dry_run, "say what would run, run nothing");
  reproduce->footer(
      "A run that is stopped goes on when it is started again.\n\n"
      "Examples:\n  mocurate reproduce list\n  mocurate reproduce a2m/table3\n"
      "  mocurate reproduce actor/table3 --profile smoke -o runs/table3\n"
      "  mocurate reproduce a2m/table1 --data humanact12=/data/HumanAct12 --time-budget 3h");
  reproduce->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return ReproduceVerb(common, *arguments); }; });
}

}  // namespace mocurate
