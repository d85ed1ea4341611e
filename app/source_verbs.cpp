// Verbs about captures and this machine: inspect, synthesize, config, doctor, cache.

#include "app/commands.h"
#include "core/base/text.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {
namespace {

/// CLI11 converts a whole number beyond 64 bits to the largest one.
std::string RefuseLongWhole(const std::string& text) {
  return ParseInteger(text) ? "" : "'" + text + "' is not a whole number of 64 bits";
}

void AddInspect(const CommandLine& line) {
  auto arguments = std::make_shared<InspectArguments>();
  CLI::App* inspect =
      line.app.add_subcommand("inspect", "Describe a file or folder: declarations, measurements, suspect clips");
  inspect->add_option("path", arguments->path, "file or folder")->required();
  inspect->add_option("--source", arguments->source,
                      "name of a source declaration of configs/sources (precedes a file of that name, "
                      "./NAME), or a config");
  inspect->footer(
      "Examples:\n  mocurate inspect walk.bvh\n  mocurate inspect runs/kard/dataset.h5 --json\n"
      "  mocurate inspect a01_s01_e01.txt --source kard");
  line.Calls(inspect, InspectVerb, arguments);
}

void AddSynthesize(const CommandLine& line) {
  auto arguments = std::make_shared<SynthesizeArguments>();
  CLI::App* synthesize = line.app.add_subcommand(
      "synthesize", "Write a synthetic capture in the file layout of a real set, with ground truth");
  synthesize->add_option("config", arguments->config,
                         "YAML file with the studio's options (default: built-in options)");
  std::string layouts;
  for (const std::string& name : StudioLayoutNames()) layouts += " " + name;
  synthesize->add_option("--layout", arguments->layout, "file layout:" + layouts);
  synthesize->add_option("-o,--output", arguments->output, "output folder, new or empty");
  synthesize->add_option("--seed", arguments->seed, "seed of all random draws")->check(&RefuseLongWhole);
  AddAssignments(synthesize, arguments->assignments,
                 "override an option, e.g. --set depth.noise=3mm; --set clips=N: at most N of each action, or "
                 "variant of one, per person; 0: as in the set");
  AddJobCount(synthesize, arguments->jobs, "threads (default: one per core); the output does not depend on it");
  synthesize->add_flag("--show", arguments->show, "print all options with their values, write nothing");
  synthesize->footer(
      "Examples:\n  mocurate synthesize --layout ntu -o studio_ntu --seed 3 --set depth.every=10\n"
      "  mocurate synthesize --layout humanact12 -o studio_ha12 --set subjects=0 --set clips=0\n"
      "  mocurate synthesize --layout phspd -o studio_phspd --set actions='[walk]' --set body=body_cc0.h5\n"
      "  mocurate synthesize --layout openpose --show");
  line.Calls(synthesize, SynthesizeVerb, arguments);
}

void AddConfig(const CommandLine& line) {
  auto arguments = std::make_shared<ConfigArguments>();
  CLI::App* config = line.app.add_subcommand(
      "config", "Show a resolved config, write a declaration for captures, the JSON Schema, all options");
  config->require_subcommand(1);
  CLI::App* show = config->add_subcommand("show", "Resolved options as YAML");
  show->add_option("config", arguments->config,
                   "YAML file, or the name of a job, as for run (default: the embedded config)");
  AddAssignments(show, arguments->assignments, "override an option");
  show->add_flag("--origins", arguments->origins, "show the origin of each value");
  show->footer("Example:\n  mocurate config show kard --origins");
  line.Calls(show, ShowConfigVerb, arguments);
  auto making = std::make_shared<InitConfigArguments>();
  CLI::App* init = config->add_subcommand("init", "Write the declaration of a source from an inspection of its files");
  init->add_option("path", making->path, "file or folder with captures")->required();
  init->add_option("-o,--output", making->output, "file to write (default: stdout)");
  init->add_option("--name", making->name, "name of the source (default: of the folder)");
  init->add_flag("--force", making->force, "overwrite the file");
  init->footer("Example:\n  mocurate config init /data/my_kinect -o my.yaml");
  line.Calls(init, InitConfigVerb, making);
  CLI::App* schema = config->add_subcommand("schema", "JSON Schema of configs, for editors");
  schema->footer("Example:\n  mocurate config schema > mocurate.schema.json");
  line.Calls(
      schema, [](CommonArguments& common, const auto&) { return ConfigSchemaVerb(common); }, arguments);
  CLI::App* reference =
      config->add_subcommand("reference", "Every option with unit, default, range and help (Markdown)");
  reference->footer("Example:\n  mocurate config reference > options.md");
  line.Calls(
      reference, [](CommonArguments& common, const auto&) { return ConfigReferenceVerb(common); }, arguments);
}

void AddDoctor(const CommandLine& line) {
  auto arguments = std::make_shared<DoctorArguments>();
  CLI::App* doctor = line.app.add_subcommand("doctor", "Check this machine: programs, libraries, BLAS, threads, space");
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
  const auto call = [](CommonArguments& common, const DoctorArguments& given) {
    if (!given.protocol.empty()) return DoctorProtocolVerb(common, given);
    return given.source.empty() ? DoctorVerb(common) : DoctorSourceVerb(common, given);
  };
  line.Calls(doctor, call, arguments);
}

void AddCache(const CommandLine& line) {
  auto arguments = std::make_shared<CacheArguments>();
  CLI::App* cache = line.app.add_subcommand("cache", "Inspect and clean the cache of finished work");
  cache->require_subcommand(1);
  const auto add = [&](const char* action, const char* help, const char* example) {
    CLI::App* sub = cache->add_subcommand(action, help);
    sub->footer(std::string("Example:\n  mocurate cache ") + example);
    const auto call = [action](CommonArguments& common, CacheArguments& given) {
      given.action = action;
      return CacheVerb(common, given);
    };
    line.Calls(sub, call, arguments);
    return sub;
  };
  add("stat", "Count objects and bytes", "stat");
  add("verify", "Compare every object with its recorded hash", "verify");
  CLI::App* prune = add("prune", "Remove objects not used recently", "prune --days 7");
  prune->add_option("--days", arguments->days, "remove objects unused for this many days (default 30)")
      ->check(CLI::Range(0.0, 36500.0));
  prune->add_flag("-n,--dry-run", arguments->dry_run, "show what would be removed, remove nothing");
}

}  // namespace

void AddSourceVerbs(const CommandLine& line) {
  for (const auto add : {AddInspect, AddSynthesize, AddConfig, AddDoctor, AddCache}) add(line);
}

}  // namespace mocurate
