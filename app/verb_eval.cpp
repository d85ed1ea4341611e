#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/commands.h"
#include "eval/dose/damages.h"
#include "job/protocols.h"

namespace mocurate {

void AddEval(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<EvalArguments>();
  std::string protocols;
  for (const std::string& name : ProtocolNames()) protocols += (protocols.empty() ? "" : ", ") + name;
  CLI::App* eval = app.add_subcommand("eval", "Score generated motions of any program with the papers' metrics");
  eval->add_option("--protocol", arguments->protocol, "scoring protocol: " + protocols + ", or a YAML file")
      ->required();
  eval->add_option(
          "--generated", arguments->generated,
          "motions to score, a file or a folder: a dataset or MotionSet of mocurate; .npy of (motions, frames, "
          "joints, 3) or (motions, frames, 3 joints); MDM's results.npy; ACTOR's generation.npy; a folder of "
          "one motion per file; BVH; AMASS .npz. NAME=PATH names the row; may be repeated")
      ->allow_extra_args(false);
  eval->add_option(
          "--labels", arguments->labels,
          "labels of the generated motions: .npy of class indices or names, .csv of 'name,label' lines, or a "
          "label per line, in the order of the motions or of the folder's file names; once for all sets, or once "
          "for each. Default: file names of a folder that begin with a class")
      ->allow_extra_args(false);
  eval->add_option(
          "--lengths", arguments->lengths,
          "numbers of frames of the generated motions, which are cut to them: a text of one number a line, or .npy, in "
          "the order of the motions; once for all sets, or once for each")
      ->allow_extra_args(false);
  eval->add_option("--padding", arguments->padding,
                   "trailing frames that are all zero or, in files of other programs, repeat the last pose: cut "
                   "(default), or keep: scored as given, with a warning")
      ->check(CLI::IsMember({"cut", "keep"}));
  eval->add_option("--values", arguments->values,
                   "content of a bare array: joints (positions), or lie (Action2Motion's raw outputs)")
      ->check(CLI::IsMember({"joints", "lie"}));
  eval->add_option(
      "--bone-lengths", arguments->bone_lengths,
      "motions as positions, whose median bone lengths are used for Lie parameters (implies --values lie)");
  eval->add_option("--source", arguments->source,
                   "source declaration of the generated motions: a name of configs/sources, or a YAML file (default: "
                   "bare arrays have the extractor's frame, other files their own)");
  eval->add_option("--real", arguments->real,
                   "real motions: a dataset (mocurate run configs/humanact12.yaml --to assemble), or files as above");
  eval->add_option("--real-source", arguments->real_source, "source declaration of the real motions");
  eval->add_option("--real-labels", arguments->real_labels, "labels of the real motions, as for --labels");
  eval->add_option("--run", arguments->run,
                   "with --protocol own: a run folder; scored with its first recogniser, its dataset "
                   "as real motions");
  eval->add_option("--extractor", arguments->extractor,
                   "extractor instead of the protocol's: a name of configs/extractors, a YAML file, or a checkpoint");
  CLI::Option* dose_response =
      eval->add_option("--dose-response", arguments->damaged_real,
                       "instead of --generated: real motions (as for --real) to damage by known doses; tables and "
                       "a plot show each metric's response (default: the dataset of --run)")
          ->expected(0, 1);
  std::string damages;
  for (const DamageInfo& info : Damages()) damages += (damages.empty() ? "" : ", ") + std::string(info.name);
  eval->add_option("--doses", arguments->doses, "a damage and its doses, of: " + damages + "; may be repeated")
      ->type_name("NAME=DOSE,...")
      ->allow_extra_args(false);
  eval->add_option("--seed", arguments->seed, "seed of the damages (default 1)");
  eval->add_option("-o,--output", arguments->output, "folder for features/SET.h5, tables/ and metrics.json");
  eval->add_option("--set", arguments->assignments,
                   "override an option of the protocol or its extractor, e.g. --set variant=released, "
                   "--set extractor.generated_root=first_frame")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  eval->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")
      ->check(CLI::Range(0, 1024));
  eval->footer(
      "Each motion is scored once as given (--set variant=released samples as the papers' code does). Published "
      "weights\n"
      "are searched below the folder MOCURATE_WEIGHTS (mocurate doctor --protocol NAME).\n\n"
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

}  // namespace mocurate
