#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddInspect(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<InspectArguments>();
  CLI::App* inspect =
      app.add_subcommand("inspect", "Describe a file or folder: declarations, measurements, suspect clips");
  inspect->add_option("path", arguments->path, "file or folder")->required();
  inspect->add_option("--source", arguments->source,
                      "name of a source declaration of configs/sources (precedes a file of that name, "
                      "./NAME), or a config");
  inspect->footer(
      "Examples:\n  mocurate inspect walk.bvh\n  mocurate inspect runs/kard/dataset.h5 --json\n"
      "  mocurate inspect a01_s01_e01.txt --source kard");
  inspect->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return InspectVerb(common, *arguments); }; });
}

}  // namespace mocurate
