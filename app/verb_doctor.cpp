#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddDoctor(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<DoctorArguments>();
  CLI::App* doctor = app.add_subcommand("doctor", "Check this machine: programs, libraries, BLAS, threads, space");
  CLI::Option* source = doctor->add_option(
      "--source", arguments->source,
      "name of a source declaration of configs/sources, or a config: list expected files, their folder, "
      "licence, and missing files");
  doctor
      ->add_option("--protocol", arguments->protocol,
                   "a protocol of configs/protocols: list its weights, where they are searched, and missing ones")
      ->excludes(source);
  doctor->add_option("--path", arguments->path, "folder with the captures of --source")->needs(source);
  doctor->footer(
      "Examples:\n  mocurate doctor\n  mocurate doctor --source uestc --path /data/uestc\n"
      "  mocurate doctor --protocol a2m-humanact12");
  doctor->callback([&common, &verb, arguments] {
    verb = [&common, arguments] {
      if (!arguments->protocol.empty()) return DoctorProtocolVerb(common, *arguments);
      return arguments->source.empty() ? DoctorVerb(common) : DoctorSourceVerb(common, *arguments);
    };
  });
}

}  // namespace mocurate
