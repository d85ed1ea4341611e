// The command: reads the command line, calls one verb, turns its result into an exit code.

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/protocols.h"
#include "app/usage.h"
#include "app/verbs.h"
#include "canon/exports/layout.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "eval/dose/damages.h"
#include "ingest/synthetic/studio_options.h"

namespace {

using namespace mocurate;

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 more failures than tolerated; 2 usage or config; 3 input unusable; 4 something is missing "
    "on\n"
    "this machine (see mocurate doctor); 70 a defect; 74 output cannot be written; 75 interrupted, run again to go on.";

void PrintError(const Error& error, int exit_code) {
  const nlohmann::json document = {{"error",
                                    {{"code", Name(error.code)},
                                     {"what", error.what},
                                     {"where", error.where},
                                     {"hint", error.hint},
                                     {"exit_code", exit_code}}},
                                   {"findings",
                                    {{{"code", Name(error.code)},
                                      {"severity", "error"},
                                      {"where", error.where},
                                      {"value", nullptr},
                                      {"message", error.what + (error.hint.empty() ? "" : " (" + error.hint + ")")}}}}};
  std::printf("%s\n", document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

int Report(const Status& status, const CommonArguments& common) {
  if (status) return static_cast<int>(ExitCode::kDone);
  const Error& error = status.error();
  const int exit_code = static_cast<int>(ExitCodeOf(error.code));
  if (common.json && !common.answered) PrintError(error, exit_code);
  std::fprintf(stderr, "mocurate: %s\n", error.Message().c_str());
  return exit_code;
}

/// Help and version as one document: what would stand on stdout.
void PrintAnswer(const CLI::App& app, const CLI::ParseError& asked) {
  const bool version = dynamic_cast<const CLI::CallForVersion*>(&asked) != nullptr;
  const nlohmann::json document =
      version ? nlohmann::json{{"program", "mocurate"}, {"version", Version()}} : nlohmann::json{{"help", app.help()}};
  std::printf("%s\n", document.dump(1).c_str());
}

/// Help and version go to stdout and are no error, unless they are asked of a verb that does not exist; all else is
/// wrong usage.
int ReportParse(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  CommonArguments common;
  common.json = std::any_of(argv, argv + argc, [](const char* word) { return std::strcmp(word, "--json") == 0; });
  if (error.get_exit_code() != 0) return Report(tl::unexpected<Error>(UsageError(app, error, argc, argv)), common);
  if (const auto unknown = UnknownVerb(app, argc, argv)) return Report(tl::unexpected<Error>(*unknown), common);
  if (!common.json) return app.exit(error);
  PrintAnswer(app, error);
  return 0;
}

/// The text of a result goes nowhere, whichever verb prints it. Where there is no /dev/null it is printed.
void DiscardStdout() {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  close(nowhere);
}

/// An answer that did not reach stdout whole is none: 74 instead of 0.
int ExitCodeAfterFlush(int exit_code) {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0) return exit_code;
  const std::string why = errno == 0 ? "" : std::string(": ") + std::strerror(errno);
  std::fprintf(stderr, "mocurate: stdout: cannot be written%s (free space or send the output elsewhere)\n",
               why.c_str());
  return exit_code == 0 ? static_cast<int>(ExitCode::kCannotWrite) : exit_code;
}

void AddRun(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* run = app.add_subcommand("run", "Run a job: ingest, fit, canonicalise, assemble, train, score, report");
  run->add_option(
      "config", arguments->config,
      "YAML file, or the name of a job of configs (kard, reannotate/kard), which goes before a file of that name "
      "(./NAME); without one the embedded synthetic capture runs");
  run->add_option("-o,--output", arguments->output, "run folder (default runs/NAME)");
  run->add_option("--set", arguments->assignments, "override an option, e.g. --set ingest.path=DIR")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  run->add_option("--to", arguments->to,
                  "last stage: ingest proportions fitting canon assemble audit train table report");
  run->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")->check(CLI::Range(0, 1024));
  run->add_option("--budget", arguments->budget, "train the generator this many times longer than the config says")
      ->check(CLI::Range(0.001, 1e6));
  run->add_option("--data", arguments->data, "NAME=PATH: your copy of a set of a run over several; may be repeated")
      ->allow_extra_args(false);
  run->add_flag("-n,--dry-run", arguments->dry_run, "say what would run and what the cache serves, run nothing");
  run->footer(
      "Examples:\n  mocurate run\n  mocurate run kard -o runs/kard\n"
      "  mocurate run kard --set ingest.path=/data/my_kinect --to assemble\n  mocurate run my.yaml\n"
      "  mocurate run reannotate/kard --set report.videos=false   # they can take longer than the fits");
  run->callback([&common, &verb, arguments] { verb = [&common, arguments] { return RunVerb(common, *arguments); }; });
}

void AddFit(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* fit = app.add_subcommand("fit", "Fit skeleton rotations to captures or motions, without a config");
  fit->add_option("path", arguments->path, "file or folder: captures, or a dataset or MotionSet")->required();
  fit->add_option("-o,--output", arguments->output, "dataset to write (HDF5)")->required();
  fit->add_option("--skeleton", arguments->skeleton,
                  "of the fitted motion (default: one that has the tracked joints; rotations are kept)");
  fit->add_option(
      "--source", arguments->source,
      "source declaration of configs/sources, by its name, which goes before a file of that name, or a config");
  fit->add_option("--clip", arguments->clips, "which clip, as `inspect` names it: a file, '[3]' in a file of several")
      ->allow_extra_args(false);
  fit->add_option("--set", arguments->assignments, "override an option, e.g. --set ingest.source.rate='30 Hz'")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  fit->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")->check(CLI::Range(0, 1024));
  fit->add_flag("--contacts", arguments->contacts, "remove foot sliding: feet that stand are held where they stand");
  fit->add_flag("--force", arguments->force, "overwrite the output");
  fit->footer(
      "Clips of one person are measured and fitted as one body; where nothing tells who performs, each recording is a\n"
      "body of its own (--set proportions.body_of=person or recording says otherwise).\n\n"
      "Examples:\n  mocurate fit walk.bvh --skeleton smpl24 -o walk.h5\n"
      "  mocurate fit a01_s01_e01_realworld.txt --source kard -o clip.h5\n"
      "  mocurate fit clips.npz --clip '[walk]' --set ingest.source.rate='30 Hz' -o walk.h5\n"
      "  mocurate fit generated.h5 --contacts -o standing.h5");
  fit->callback([&common, &verb, arguments] { verb = [&common, arguments] { return FitVerb(common, *arguments); }; });
}

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
  std::string layout_help = "how they are laid out (default npz):";
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
  verb_export->add_option("--source", arguments->source, "source declaration, where the files do not say it");
  verb_export->add_option("--clip", arguments->clips, "which clip, by its id or the end of it (default: all)")
      ->allow_extra_args(false);
  verb_export->add_option("--split", arguments->split,
                          "which split is written (default: all; amass_babel carries one, the first)");
  verb_export->add_flag("--force", arguments->force, "overwrite files, and write into a folder that is not empty");
  verb_export->footer(
      "Each folder holds source.yaml, with which mocurate reads it again (docs/exports.md).\n\n"
      "Examples:\n  mocurate export walk.h5 -o walk.npz --as axis_angle\n"
      "  mocurate export walk.bvh -o walk.npz --as quaternion\n"
      "  mocurate export runs/kard/dataset.h5 -o arrays --as 6d_rows\n"
      "  mocurate export runs/kard/dataset.h5 -o blender --layout bvh\n"
      "  mocurate export runs/kard/dataset.h5 -o amass --layout amass_babel --split cross_subject\n"
      "  mocurate export runs/demo/checkpoints/Action2Motion_1.h5 -o action2motion.safetensors");
  verb_export->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return ExportVerb(common, *arguments); }; });
}

void AddEval(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<EvalArguments>();
  std::string protocols;
  for (const std::string& name : ProtocolNames()) protocols += (protocols.empty() ? "" : ", ") + name;
  CLI::App* eval = app.add_subcommand("eval", "Score generated motions, of any program, with the papers' metrics");
  eval->add_option("--protocol", arguments->protocol, "how they are scored: " + protocols + ", or a YAML file")
      ->required();
  eval->add_option(
          "--generated", arguments->generated,
          "motions to score, a file or a folder: a dataset or MotionSet of mocurate; .npy of (motions, frames, "
          "joints, 3) or (motions, frames, 3 joints); MDM's results.npy; ACTOR's generation.npy; a folder of "
          "one motion a file; BVH; AMASS .npz. NAME=PATH names the row; may be repeated")
      ->allow_extra_args(false);
  eval->add_option(
          "--labels", arguments->labels,
          "labels of the generated motions: .npy of class indices or names, .csv of 'name,label' lines, or a "
          "label a line, in the order of the motions or of the folder's file names; once for all sets, or once "
          "for each. Without it a folder's files are labelled by names that begin with a class")
      ->allow_extra_args(false);
  eval->add_option("--values", arguments->values,
                   "what a bare array holds: joints (positions), or lie (Action2Motion's raw outputs)")
      ->check(CLI::IsMember({"joints", "lie"}));
  eval->add_option("--bone-lengths", arguments->bone_lengths,
                   "motions as positions whose median bone lengths lay out Lie parameters (implies --values lie)");
  eval->add_option("--source", arguments->source,
                   "source declaration of the generated motions: a name of configs/sources, or a YAML file (default: "
                   "bare arrays stand in the extractor's frame, other files say it themselves)");
  eval->add_option("--real", arguments->real,
                   "real motions: a dataset (mocurate run configs/humanact12.yaml --to assemble), or files as above");
  eval->add_option("--real-source", arguments->real_source, "source declaration of the real motions");
  eval->add_option("--real-labels", arguments->real_labels, "labels of the real motions, as --labels");
  eval->add_option("--run", arguments->run,
                   "with --protocol own: a run folder; its first recogniser scores, its dataset "
                   "is the real motions");
  eval->add_option("--extractor", arguments->extractor,
                   "instead of the protocol's: a name of configs/extractors, a YAML file, or a checkpoint");
  CLI::Option* dose_response =
      eval->add_option("--dose-response", arguments->damaged_real,
                       "instead of --generated: real motions, as --real, which are damaged by known doses; tables and "
                       "a plot show how each metric answers (default: the dataset of --run)")
          ->expected(0, 1);
  std::string damages;
  for (const DamageInfo& info : Damages()) damages += (damages.empty() ? "" : ", ") + std::string(info.name);
  eval->add_option("--doses", arguments->doses, "one of these damages, and its doses: " + damages + "; may be repeated")
      ->type_name("NAME=DOSE,...")
      ->allow_extra_args(false);
  eval->add_option("--seed", arguments->seed, "of the damages (default 1)");
  eval->add_option("-o,--output", arguments->output, "folder for features/SET.h5, tables/ and metrics.json");
  eval->add_option("--set", arguments->assignments,
                   "override an option of the protocol or its extractor, e.g. --set variant=released, "
                   "--set extractor.generated_root=first_frame")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  eval->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")
      ->check(CLI::Range(0, 1024));
  eval->footer(
      "Each motion is scored once as given (--set variant=released draws as the papers' code does). Published weights\n"
      "are looked for below the folder MOCURATE_WEIGHTS (mocurate doctor --protocol NAME).\n\n"
      "Examples:\n"
      "  mocurate eval --protocol a2m-humanact12 --generated motion_joints.npy --labels motion_class.npy\n"
      "  mocurate eval --protocol a2m-humanact12 --generated mdm=results.npy --generated ours.npy --labels labels.csv "
      "\\\n"
      "    --real runs/humanact12/dataset.h5 -o scores\n"
      "  mocurate eval --protocol a2m-ntu13 --generated raw.npy --bone-lengths joints.npy --labels classes.npy\n"
      "  mocurate eval --protocol own --run runs/kard --generated generated.h5 --json\n"
      "  mocurate eval --protocol own --run runs/kard --dose-response --doses jitter_mm=1,5,20 -o doses");
  eval->callback([&common, &verb, arguments, dose_response] {
    arguments->dose_response = dose_response->count() > 0;
    verb = [&common, arguments] { return EvalVerb(common, *arguments); };
  });
}

void AddGenerate(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<GenerateArguments>();
  CLI::App* generate = app.add_subcommand("generate", "Generate motions with a trained network");
  generate->add_option("checkpoint", arguments->checkpoint, "of a generator: RUN/checkpoints/NAME_SEED.h5")->required();
  generate
      ->add_option("--label", arguments->labels,
                   "class, by name or index, and how many: sit:10; may be repeated (default: each class once)")
      ->allow_extra_args(false);
  generate->add_option(
      "--frames", arguments->frames,
      "of each motion (default: as many as the network was trained on); FIRST:LAST[:STEP]: each of these");
  generate
      ->add_option("--interpolate", arguments->interpolate,
                   "for each motion that is asked for, so many on the way between two latents (kind actor)")
      ->check(CLI::Range(2, 100000));
  generate
      ->add_option("--script", arguments->scripts,
                   "actions one after the other, a motion: throw,catch:30,throw (ACTION:FRAMES), a name of "
                   "configs/scripts, or a YAML file; may be repeated (kind macvae, or actor with joined motions)")
      ->allow_extra_args(false);
  generate->add_option("--count", arguments->count, "motions of each script")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  generate
      ->add_option("--transition-frames", arguments->transition_frames,
                   "of all transitions (default: those of the script, else usual ones of the training set)")
      ->check(CLI::Range(1, 100000));
  generate->add_option("--first", arguments->first,
                       "checkpoint of an actor, which makes the first action where the network continues motions");
  generate->add_option("--previous", arguments->previous,
                       "dataset whose motions the scripts continue in the place of a first action that is made");
  generate->add_option("--previous-clip", arguments->previous_clip,
                       "id of the motion in it (default: drawn by --seed)");
  generate->add_option(
      "--fill", arguments->fill,
      "checkpoint of an ssmct, which fills transitions between an actor's motions (default: linearly)");
  generate->add_flag("--align", arguments->align,
                     "turn and move each of an actor's motions to where the one before ends");
  generate->add_flag(
      "--snap", arguments->snap,
      "let what continues a motion begin at its last frame's place and heading, as MultiAct's code does");
  generate->add_option("--denoise", arguments->denoise,
                       "dataset whose clips are encoded and decoded, with their labels and lengths (kind actor)");
  generate->add_option("--seed", arguments->seed, "of the noise: the same seed, the same motions")
      ->capture_default_str();
  generate->add_option("--scale", arguments->scale,
                       "bone lengths times a factor, rotations unchanged: legs=1.25,arms=1.25 or all=0.8");
  generate->add_option("--bone-lengths", arguments->bone_lengths,
                       "dataset or MotionSet whose mean bone lengths lay the motions out");
  generate->add_option("--mesh", arguments->mesh,
                       "folder for the motions as meshes too: an .npz of vertices and faces for each motion and body");
  generate->add_option("--shapes", arguments->shapes, "bodies of each motion: the mean one, then drawn ones")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  generate->add_option(
      "--body", arguments->body,
      "of the meshes: SMPL_NEUTRAL.pkl or body_cc0.h5 (default: the one below MOCURATE_WEIGHTS or MOCURATE_DATA)");
  generate->add_option("-o,--output", arguments->output, "MotionSet (.h5), which eval, export and fit take")
      ->required();
  generate->add_flag("--force", arguments->force, "overwrite");
  generate->footer(
      "Examples:\n  mocurate generate runs/demo/checkpoints/Action2Motion_1.h5 --label kick:10 --label walk:5 -o "
      "made.h5\n"
      "  mocurate generate runs/demo/checkpoints/Action2Motion_1.h5 --scale legs=1.25,arms=1.25 -o long_limbs.h5\n"
      "  mocurate generate ACTOR_1.h5 --label walk:10 --frames 40:120:5 -o durations.h5\n"
      "  mocurate generate ACTOR_1.h5 --label walk --interpolate 9 -o between.h5\n"
      "  mocurate generate ACTOR_1.h5 --denoise runs/demo/dataset.h5 -o denoised.h5\n"
      "  mocurate generate ACTOR_1.h5 --label walk --mesh meshes --shapes 3 --body body_cc0.h5 -o walk.h5\n"
      "  mocurate generate MACVAE_1.h5 --first ACTOR_1.h5 --script throw,catch:30,throw -o long.h5\n"
      "  mocurate generate MACVAE_1.h5 --previous dataset.h5 --script throw_catch --count 10 -o continued.h5\n"
      "  mocurate eval --protocol own --run runs/demo --generated made.h5");
  generate->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return GenerateVerb(common, *arguments); }; });
}

void AddInspect(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<InspectArguments>();
  CLI::App* inspect = app.add_subcommand("inspect", "Tell what a file or folder is: declared, measured, doubtful");
  inspect->add_option("path", arguments->path, "file or folder")->required();
  inspect->add_option("--source", arguments->source,
                      "source declaration of configs/sources, by its name, which goes before a file of that name "
                      "(./NAME), or a config");
  inspect->footer(
      "Examples:\n  mocurate inspect walk.bvh\n  mocurate inspect runs/kard/dataset.h5 --json\n"
      "  mocurate inspect a01_s01_e01.txt --source kard");
  inspect->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return InspectVerb(common, *arguments); }; });
}

/// CLI11 takes a whole number beyond 64 bits for the largest there is.
std::string RefuseLongWhole(const std::string& text) {
  return ParseInteger(text) ? "" : "'" + text + "' is no whole number of 64 bits";
}

void AddSynthesize(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<SynthesizeArguments>();
  CLI::App* synthesize = app.add_subcommand(
      "synthesize", "Write a synthetic capture in the files of a real set, with the truth beside it");
  synthesize->add_option("config", arguments->config, "YAML file with the studio's options; without one its defaults");
  std::string layouts;
  for (const std::string& name : StudioLayoutNames()) layouts += " " + name;
  synthesize->add_option("--layout", arguments->layout, "whose files:" + layouts);
  synthesize->add_option("-o,--output", arguments->output, "folder to write, empty or not there yet");
  synthesize->add_option("--seed", arguments->seed, "of everything random")->check(&RefuseLongWhole);
  synthesize
      ->add_option("--set", arguments->assignments,
                   "override an option, e.g. --set depth.noise=3mm; --set clips=N: at most N of each action, or "
                   "variant of one, by each person, 0: as the set has")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  synthesize->add_option("-j,--jobs", arguments->jobs, "threads (default: one per core); the bytes do not depend on it")
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

void AddConfig(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<ConfigArguments>();
  CLI::App* config =
      app.add_subcommand("config", "Show a resolved config, write one for captures, its JSON Schema, all options");
  config->require_subcommand(1);
  CLI::App* show = config->add_subcommand("show", "Resolved options as YAML");
  show->add_option("config", arguments->config,
                   "YAML file, or the name of a job, as for run; without one the embedded default");
  show->add_option("--set", arguments->assignments, "override an option")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  show->add_flag("--origins", arguments->origins, "say where each value comes from");
  show->footer("Example:\n  mocurate config show kard --origins");
  show->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return ShowConfigVerb(common, *arguments); }; });
  auto making = std::make_shared<InitConfigArguments>();
  CLI::App* init = config->add_subcommand("init", "Write the declaration of a source from what its files show");
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

void AddDoctor(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<DoctorArguments>();
  CLI::App* doctor = app.add_subcommand("doctor", "Check this machine: programs, libraries, BLAS, threads, space");
  CLI::Option* source = doctor->add_option(
      "--source", arguments->source,
      "source declaration of configs/sources, by its name, or a config: which files it expects, where, under which "
      "licence, what is missing");
  doctor
      ->add_option(
          "--protocol", arguments->protocol,
          "a protocol of configs/protocols: which weights it needs, where they are looked for, what is missing")
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

void AddCache(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<CacheArguments>();
  CLI::App* cache = app.add_subcommand("cache", "Look after the cache of finished work");
  cache->require_subcommand(1);
  const auto add = [&](const char* action, const char* help, const char* example) {
    CLI::App* sub = cache->add_subcommand(action, help);
    sub->footer(std::string("Example:\n  mocurate cache ") + example);
    sub->callback([&common, &verb, arguments, action] {
      arguments->action = action;
      verb = [&common, arguments] { return CacheVerb(common, *arguments); };
    });
    return sub;
  };
  add("stat", "Count objects and bytes", "stat");
  add("verify", "Compare every object with its recorded hash", "verify");
  CLI::App* prune = add("prune", "Remove objects that were not used for some days", "prune --days 7");
  prune->add_option("--days", arguments->days, "unused for this many days (default 30)")
      ->check(CLI::Range(0.0, 36500.0));
  prune->add_flag("-n,--dry-run", arguments->dry_run, "say what would be removed, remove nothing");
}

int Run(int argc, char** argv) {
  CommonArguments common;
  std::function<Status()> verb;
  CLI::App app("mocurate: from noisy motion captures to datasets that can be trusted");
  app.set_version_flag("--version", std::string(CreatedBy()));
  app.add_flag("--json", common.json, "the result as one JSON document on stdout");
  app.add_flag("-q,--quiet", common.quiet,
               "errors only: no result (but the document of --json), no progress, no warnings");
  app.add_flag("-v,--verbose", common.verbose, "more log lines");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(kFooter);
  AddRun(app, common, verb);
  AddFit(app, common, verb);
  AddExport(app, common, verb);
  AddGenerate(app, common, verb);
  AddDraw(app, common, verb);
  AddReproduce(app, common, verb);
  AddEval(app, common, verb);
  AddAudit(app, common, verb);
  AddReview(app, common, verb);
  AddSurvey(app, common, verb);
  AddDataset(app, common, verb);
  AddInspect(app, common, verb);
  AddSynthesize(app, common, verb);
  AddConfig(app, common, verb);
  AddDoctor(app, common, verb);
  AddCache(app, common, verb);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return ReportParse(app, error, argc, argv);
  }
  SetLogLevel(common.quiet ? LogLevel::kError : common.verbose ? LogLevel::kDebug : LogLevel::kInfo);
  if (common.quiet && !common.json) DiscardStdout();
  try {
    return Report(verb(), common);
  } catch (const std::exception& defect) {
    return Report(Fail(ErrorCode::kInternal, defect.what(), "", "this is a defect of mocurate; please report it"),
                  common);
  }
}

}  // namespace

int main(int argc, char** argv) { return ExitCodeAfterFlush(Run(argc, argv)); }
