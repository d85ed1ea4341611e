#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddFit(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* fit = app.add_subcommand("fit", "Fit skeleton rotations to captures or motions, without a config");
  fit->add_option("path", arguments->path, "file or folder: captures, or a dataset or MotionSet")->required();
  fit->add_option("-o,--output", arguments->output, "dataset to write (HDF5)")->required();
  fit->add_option("--skeleton", arguments->skeleton,
                  "skeleton of the fitted motion (default: one with the tracked joints; recorded rotations are kept)");
  fit->add_option("--source", arguments->source,
                  "name of a source declaration of configs/sources (precedes a file of that name), or a config");
  fit->add_option("--clip", arguments->clips, "clip to fit, as named by `inspect`: a file, '[3]' in a file of several")
      ->allow_extra_args(false);
  fit->add_option("--set", arguments->assignments, "override an option, e.g. --set ingest.source.rate='30 Hz'")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  fit->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")->check(CLI::Range(0, 1024));
  fit->add_flag("--contacts", arguments->contacts, "remove foot sliding: feet keep their place during contact");
  fit->add_flag("--force", arguments->force, "overwrite the output");
  fit->footer(
      "Clips of one person are measured and fitted as one body. Without a known person, each recording is a\n"
      "body of its own (change this with --set proportions.body_of=person or recording).\n\n"
      "Examples:\n  mocurate fit walk.bvh --skeleton smpl24 -o walk.h5\n"
      "  mocurate fit a01_s01_e01_realworld.txt --source kard -o clip.h5\n"
      "  mocurate fit clips.npz --clip '[walk]' --set ingest.source.rate='30 Hz' -o walk.h5\n"
      "  mocurate fit generated.h5 --contacts -o standing.h5");
  fit->callback([&common, &verb, arguments] { verb = [&common, arguments] { return FitVerb(common, *arguments); }; });
}

}  // namespace mocurate
