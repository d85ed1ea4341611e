#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/commands.h"
#include "canon/exports/layout.h"
#include "core/base/text.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {
namespace {

/// CLI11 converts a whole number beyond 64 bits to the largest one.
std::string RefuseLongWhole(const std::string& text) {
  return ParseInteger(text) ? "" : "'" + text + "' is not a whole number of 64 bits";
}

}  // namespace

void AddSynthesize(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<SynthesizeArguments>();
  CLI::App* synthesize =
      app.add_subcommand("synthesize", "Write a synthetic capture in the file layout of a real set, with ground truth");
  synthesize->add_option("config", arguments->config,
                         "YAML file with the studio's options (default: built-in options)");
  std::string layouts;
  for (const std::string& name : StudioLayoutNames()) layouts += " " + name;
  synthesize->add_option("--layout", arguments->layout, "file layout:" + layouts);
  synthesize->add_option("-o,--output", arguments->output, "output folder, new or empty");
  synthesize->add_option("--seed", arguments->seed, "seed of all random draws")->check(&RefuseLongWhole);
  synthesize
      ->add_option("--set", arguments->assignments,
                   "override an option, e.g. --set depth.noise=3mm; --set clips=N: at most N of each action, or "
                   "variant of one, per person; 0: as in the set")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  synthesize
      ->add_option("-j,--jobs", arguments->jobs, "threads (default: one per core); the output does not depend on it")
      ->check(CLI::Range(0, 1024));
  synthesize->add_flag("--show", arguments->show, "print all options with their values, write nothing");
  synthesize->footer(
      "Examples:\n  mocurate synthesize --layout ntu -o studio_ntu --seed 3 --set depth.every=10\n"
      "  mocurate synthesize --layout humanact12 -o studio_ha12 --set subjects=0 --set clips=0\n"
      "  mocurate synthesize --layout phspd -o studio_phspd --set actions='[walk]' --set body=body_cc0.h5\n"
      "  mocurate synthesize --layout openpose --show");
  synthesize->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return SynthesizeVerb(common, *arguments); }; });
}

}  // namespace mocurate
