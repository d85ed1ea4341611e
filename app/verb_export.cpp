#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "app/commands.h"
#include "canon/exports/layout.h"

namespace mocurate {

void AddExport(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* verb_export =
      app.add_subcommand("export", "Write motions in the layouts of other programs, or a network as safetensors");
  verb_export->add_option("path", arguments->path, "file or folder of motions: dataset, BVH, AMASS, ...")->required();
  verb_export
      ->add_option("-o,--output", arguments->output,
                   "a folder; or FILE.npz, FILE.csv or FILE.bvh for one clip, FILE.pkl for --layout actor, "
                   "FILE.safetensors for a network")
      ->required();
  std::vector<std::string> layouts;
  std::string layout_help = "layout of the output (default npz):";
  for (const Layout& layout : Layouts()) {
    layouts.emplace_back(layout.name);
    layout_help += (layouts.size() > 1 ? "; " : " ") + std::string(layout.name) + ": " + std::string(layout.help);
  }
  verb_export->add_option("--layout", arguments->layout, layout_help)
      ->check(CLI::IsMember(layouts))
      ->type_name("LAYOUT");
  std::vector<std::string> names;
  std::string help = "with npz: rotations as (default " + std::string(kRotationArraysNames.front().name) + "):";
  for (const RotationArraysName& name : kRotationArraysNames) {
    names.emplace_back(name.name);
    help += " " + std::string(name.name) + (name.value == RotationArrays::kNone ? "" : ",");
  }
  verb_export->add_option("--as", arguments->rotations, help)->check(CLI::IsMember(names))->type_name("REPRESENTATION");
  verb_export->add_option("--source", arguments->source, "source declaration, for files without one of their own");
  verb_export->add_option("--clip", arguments->clips, "clip to export, by its id or the end of it (default: all)")
      ->allow_extra_args(false);
  verb_export->add_option("--split", arguments->split,
                          "split to write (default: all; amass_babel contains only one, the first)");
  verb_export
      ->add_option_function<std::string>(
          "--inferred", [arguments](const std::string& choice) { arguments->keep_inferred = choice == "keep"; },
          "frames in gaps without an observation, in layouts that do not carry states: refuse the clip (default), or "
          "keep them")
      ->check(CLI::IsMember({"refuse", "keep"}))
      ->type_name("CHOICE");
  verb_export->add_flag("--force", arguments->force, "overwrite files, and write into a folder that is not empty");
  verb_export->footer(
      "Each folder contains source.yaml, with which mocurate can read it (docs/exports.md).\n\n"
      "Examples:\n  mocurate export walk.h5 -o walk.npz --as axis_angle\n"
      "  mocurate export walk.bvh -o walk.npz --as quaternion\n"
      "  mocurate export runs/kard/dataset.h5 -o arrays --as 6d_rows\n"
      "  mocurate export runs/kard/dataset.h5 -o blender --layout bvh\n"
      "  mocurate export runs/kard/dataset.h5 -o amass --layout amass_babel --split cross_subject\n"
      "  mocurate export runs/demo/checkpoints/Action2Motion_1.h5 -o action2motion.safetensors");
  verb_export->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return ExportVerb(common, *arguments); }; });
}

}  // namespace mocurate
