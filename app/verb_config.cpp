#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddConfig(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<ConfigArguments>();
  CLI::App* config = app.add_subcommand(
      "config", "Show a resolved config, write a declaration for captures, the JSON Schema, all options");
  config->require_subcommand(1);
  CLI::App* show = config->add_subcommand("show", "Resolved options as YAML");
  show->add_option("config", arguments->config,
                   "YAML file, or the name of a job, as for run (default: the embedded config)");
  show->add_option("--set", arguments->assignments, "override an option")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  show->add_flag("--origins", arguments->origins, "show the origin of each value");
  show->footer("Example:\n  mocurate config show kard --origins");
  show->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return ShowConfigVerb(common, *arguments); }; });
  auto making = std::make_shared<InitConfigArguments>();
  CLI::App* init = config->add_subcommand("init", "Write the declaration of a source from an inspection of its files");
  init->add_option("path", making->path, "file or folder with captures")->required();
  init->add_option("-o,--output", making->output, "file to write (default: stdout)");
  init->add_option("--name", making->name, "name of the source (default: of the folder)");
  init->add_flag("--force", making->force, "overwrite the file");
  init->footer("Example:\n  mocurate config init /data/my_kinect -o my.yaml");
  init->callback([&common, &verb, making] { verb = [&common, making] { return InitConfigVerb(common, *making); }; });
  CLI::App* schema = config->add_subcommand("schema", "JSON Schema of configs, for editors");
  schema->footer("Example:\n  mocurate config schema > mocurate.schema.json");
  schema->callback([&common, &verb] { verb = [&common] { return ConfigSchemaVerb(common); }; });
  CLI::App* reference =
      config->add_subcommand("reference", "Every option with unit, default, range and help (Markdown)");
  reference->footer("Example:\n  mocurate config reference > options.md");
  reference->callback([&common, &verb] { verb = [&common] { return ConfigReferenceVerb(common); }; });
}

}  // namespace mocurate
