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
  draw->add_option("--label", arguments->labels, "class to show; may be repeated (default: all classes)")
      ->allow_extra_args(false);
  draw->add_option("--clip", arguments->clips, "id of a clip, or its end, instead of --label; may be repeated")
      ->allow_extra_args(false);
  draw->add_option("--samples", arguments->samples, "number of motions of each label and file")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  draw->add_option("--stills", arguments->stills, "number of equally spaced frames of a row")
      ->check(CLI::Range(1, 60))
      ->capture_default_str();
  draw->add_option("--figure", arguments->figure, "draw bones, capsules around them, or the skin of a rigged body")
      ->check(CLI::IsMember({"bones", "capsules", "skin"}))
      ->capture_default_str();
  draw->add_option("--body", arguments->body,
                   "SMPL_NEUTRAL.pkl or body_cc0.h5 for --figure skin (default: below MOCURATE_WEIGHTS)");
  draw->add_option("--source", arguments->source, "source declaration, for files without one of their own");
  draw->add_option("--title", arguments->title, "title above the picture");
  draw->add_option("--scale", arguments->scale, "pixels of a PNG or video per unit of the drawing")
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

}  // namespace mocurate
