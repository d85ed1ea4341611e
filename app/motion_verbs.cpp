// Verbs about motions and networks: export, generate, draw, reproduce, eval.

#include <algorithm>
#include <vector>

#include "app/commands.h"
#include "canon/exports/layout.h"
#include "core/base/text.h"
#include "eval/dose/damages.h"
#include "job/protocols.h"

namespace mocurate {
namespace {

void AddExport(const CommandLine& line) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* verb_export =
      line.app.add_subcommand("export", "Write motions in the layouts of other programs, or a network as safetensors");
  verb_export->add_option("path", arguments->path, "file or folder of motions: dataset, BVH, AMASS, ...")->required();
  verb_export
      ->add_option("-o,--output", arguments->output,
                   "a folder; or FILE.npz, FILE.csv or FILE.bvh for one clip, FILE.pkl for --layout actor, "
                   "FILE.safetensors for a network")
      ->required();
  std::vector<std::string> layouts;
  std::string layout_help = "layout of the output (default: by the ending of -o, else npz):";
  for (const Layout& layout : Layouts()) {
    layouts.emplace_back(layout.name);
    layout_help += (layouts.size() > 1 ? "; " : " ") + std::string(layout.name) + ": " + std::string(layout.help);
  }
  layouts.emplace_back(kExtractorLayout);
  layout_help += "; extractor: a recogniser's weights, what it reads, and a manifest, for eval --extractor";
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
  AddRepeated(verb_export, "--tolerate", arguments->tolerate,
              "code of a finding for which a run refuses or excludes clips, to go on with such clips; may be repeated");
  verb_export->add_option("--source", arguments->source, "source declaration, for files without one of their own");
  AddRepeated(verb_export, "--clip", arguments->clips,
              "clip to export, by its id or what stands behind a / in it (default: all)");
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
      "  mocurate export walk.h5 -o walk.glb\n"
      "  mocurate export runs/kard/dataset.h5 -o arrays --as 6d_rows\n"
      "  mocurate export runs/kard/checkpoints/recogniser_1.h5 --layout extractor -o kard_extractor\n"
      "  mocurate export runs/kard/dataset.h5 -o blender --layout bvh\n"
      "  mocurate export runs/kard/dataset.h5 -o amass --layout amass_babel --split cross_subject\n"
      "  mocurate export runs/demo/checkpoints/Action2Motion_1.h5 -o action2motion.safetensors");
  line.Calls(verb_export, ExportVerb, arguments);
}

void AddGenerate(const CommandLine& line) {
  auto arguments = std::make_shared<GenerateArguments>();
  CLI::App* generate = line.app.add_subcommand("generate", "Generate motions with a trained network");
  generate->add_option("checkpoint", arguments->checkpoint, "checkpoint of a generator: RUN/checkpoints/NAME_SEED.h5")
      ->required();
  AddRepeated(generate, "--label", arguments->labels,
              "class, by name or index, and number of motions: sit:10; may be repeated (default: each class once)");
  generate->add_option("--frames", arguments->frames,
                       "frames of each motion (default: as in training); FIRST:LAST[:STEP]: each of these");
  generate
      ->add_option("--interpolate", arguments->interpolate,
                   "for each requested motion, this number of motions interpolated between two latents (kind actor)")
      ->check(CLI::Range(2, 100000));
  AddRepeated(generate, "--script", arguments->scripts,
              "motion of several actions: throw,catch:30,throw (ACTION:FRAMES), a name of "
              "configs/scripts, or a YAML file; may be repeated (kind macvae, or actor with joined motions)");
  generate->add_option("--count", arguments->count, "number of motions of each script")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  generate
      ->add_option("--transition-frames", arguments->transition_frames,
                   "frames of each transition (default: as in the script, else usual ones of the training set)")
      ->check(CLI::Range(1, 100000));
  generate->add_option("--first", arguments->first,
                       "checkpoint of an actor for the first action, for a network that continues motions");
  generate->add_option("--previous", arguments->previous,
                       "dataset whose motions the scripts continue, instead of a generated first action");
  generate->add_option("--previous-clip", arguments->previous_clip,
                       "id of the motion to continue (default: drawn by --seed)");
  generate->add_flag("--keep-previous", arguments->keep_previous, "begin each motion with the one that it continues");
  generate->add_option("--fill", arguments->fill,
                       "checkpoint of an ssmct for transitions between an actor's motions (default: linear)");
  generate->add_flag("--align", arguments->align,
                     "rotate and move each of an actor's motions to the end of the previous one");
  generate->add_flag("--snap", arguments->snap,
                     "start each continuation at the last frame's place and heading, as MultiAct's code does");
  generate->add_option("--denoise", arguments->denoise,
                       "dataset whose clips are encoded and decoded, with their labels and durations (kind actor)");
  generate->add_option("--seed", arguments->seed, "seed of the noise; equal seeds give equal motions")
      ->capture_default_str();
  generate->add_option("--scale", arguments->scale,
                       "scale bone lengths, rotations unchanged: legs=1.25,arms=1.25 or all=0.8");
  generate->add_option("--bone-lengths", arguments->bone_lengths,
                       "dataset or MotionSet whose mean bone lengths the motions get");
  generate->add_option("--person", arguments->person, "person of --bone-lengths whose bones alone count");
  generate->add_option("--mesh", arguments->mesh,
                       "also write meshes to this folder: an .npz of vertices and faces for each motion and body");
  generate->add_option("--shapes", arguments->shapes, "number of bodies per motion: the mean one, then random ones")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  generate->add_option(
      "--body", arguments->body,
      "body of the meshes: SMPL_NEUTRAL.pkl or body_cc0.h5 (default: the one below MOCURATE_WEIGHTS or MOCURATE_DATA)");
  generate->add_option("-o,--output", arguments->output, "MotionSet (.h5), a valid input of eval, export and fit")
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
  line.Calls(generate, GenerateVerb, arguments);
}

void AddDraw(const CommandLine& line) {
  auto arguments = std::make_shared<DrawArguments>();
  CLI::App* draw = line.app.add_subcommand("draw", "Draw motions: rows of equally spaced frames, or a video");
  draw->add_option("motions", arguments->motions,
                   "datasets, MotionSets, or files and folders of motions; NAME=PATH names the row")
      ->required();
  draw->add_option("-o,--output", arguments->output, "picture (.svg, .png) or video (.mp4) to write")->required();
  AddRepeated(draw, "--label", arguments->labels, "class to show; may be repeated (default: all classes)");
  AddRepeated(draw, "--clip", arguments->clips, "id of a clip, or its end, instead of --label; may be repeated");
  draw->add_option("--samples", arguments->samples, "number of motions of each label and file")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  draw->add_option("--stills", arguments->stills, "number of equally spaced frames of a row")
      ->check(CLI::Range(1, 60))
      ->capture_default_str();
  draw->add_option("--figure", arguments->figure, "draw bones, capsules around them, or the skin of a rigged body")
      ->check(CLI::IsMember({"bones", "capsules", "skin"}))
      ->capture_default_str();
  draw->add_option(
          "--view", arguments->view,
          "front, side, three-quarter, or AZIMUTH,ELEVATION: degrees from the person's front and above the horizon")
      ->capture_default_str();
  draw->add_option("--body", arguments->body,
                   "SMPL_NEUTRAL.pkl or body_cc0.h5 for --figure skin (default: below MOCURATE_WEIGHTS)");
  AddRepeated(draw, "--tolerate", arguments->tolerate,
              "code of a finding for which a run refuses or excludes clips, to go on with such clips; may be repeated");
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
  line.Calls(draw, DrawVerb, arguments);
}

void AddView(const CommandLine& line) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* view = line.app.add_subcommand("view", "Look at motions: one page for the browser, which can be passed on");
  view->add_option("motions", arguments->motions,
                   "datasets, MotionSets, folders of runs, or files and folders of motions; NAME=PATH names one")
      ->required();
  view->add_option("-o,--output", arguments->output,
                   "page (.html) to write (default: a temporary one, opened where a desktop is)");
  AddRepeated(view, "--clip", arguments->clips, "id of a clip, or its end; may be repeated (default: all clips)");
  view->add_option("--body", arguments->body,
                   "SMPL_NEUTRAL.pkl or body_cc0.h5 to draw skinned bodies with (default: body_cc0.h5 below "
                   "MOCURATE_WEIGHTS or MOCURATE_DATA)");
  AddRepeated(view, "--tolerate", arguments->tolerate,
              "code of a finding for which a run refuses or excludes clips, to go on with such clips; may be repeated");
  view->add_flag("--audit", arguments->audit,
                 "audit the motions first: a map of the clips, those nearest to each, and findings");
  view->add_option("--source", arguments->source, "source declaration, for files without one of their own");
  view->add_option("--title", arguments->title, "title of the page");
  view->add_flag("--force", arguments->force, "overwrite the output");
  view->footer(
      "Clips of several files with the same person, recording and frames are shown side by side, or overlaid. The "
      "page\n"
      "needs no network; motions of more than 24 MB are in a folder beside it.\n\n"
      "Examples:\n  mocurate view walk.bvh\n"
      "  mocurate view runs/demo -o demo.html\n"
      "  mocurate view before=raw.h5 after=runs/kard/dataset.h5 --clip a05_s01_e01 -o both.html");
  line.Calls(view, ViewVerb, arguments);
}

void AddReproduce(const CommandLine& line) {
  auto arguments = std::make_shared<ReproduceArguments>();
  CLI::App* reproduce = line.app.add_subcommand(
      "reproduce", "Reproduce a table or figure of a paper, with the published numbers beside it");
  reproduce->add_option("id", arguments->id, "PAPER/ITEM, e.g. actor/table3; or `list` for all")->required();
  AddRepeated(reproduce, "--data", arguments->data,
              "NAME=PATH: your copy of a set; may be repeated (default: synthetic motions in its layout)");
  reproduce
      ->add_option("--profile", arguments->profile,
                   "smoke: test that it runs; small: check the order of rows; paper: as published (default small)")
      ->check(CLI::IsMember({"smoke", "small", "paper"}));
  reproduce->add_option("--time-budget", arguments->time_budget,
                        "total training time, e.g. 20min or 3h: steps are measured, then scaled");
  reproduce->add_option("-o,--output", arguments->output, "run folder (default runs/PAPER_ITEM_PROFILE)");
  AddAssignments(reproduce, arguments->assignments, "override an option of the job");
  AddJobCount(reproduce, arguments->jobs);
  reproduce->add_flag("-n,--dry-run", arguments->dry_run, "show what would run, run nothing");
  reproduce->add_flag("--replace", arguments->replace, "use the folder of another job, as of mocurate run");
  reproduce->footer(
      "A stopped run continues when it is started again.\n\n"
      "Examples:\n  mocurate reproduce list\n  mocurate reproduce a2m/table3\n"
      "  mocurate reproduce actor/table3 --profile smoke -o runs/table3\n"
      "  mocurate reproduce a2m/table1 --data humanact12=/data/HumanAct12 --time-budget 3h");
  line.Calls(reproduce, ReproduceVerb, arguments);
}

/// Error kUsage where options are given that do not apply beside `name`.
Status CheckAlone(const CLI::App& verb, const std::string& name, const std::vector<const CLI::Option*>& beside) {
  for (const CLI::Option* option : verb.get_options()) {
    if (option->count() == 0 || std::find(beside.begin(), beside.end(), option) != beside.end()) continue;
    std::vector<std::string> names;
    for (const CLI::Option* other : beside) names.push_back(other->get_name());
    return Fail(ErrorCode::kUsage, option->get_name() + " is given, but does not apply beside " + name, "command line",
                "remove it; these apply: " + JoinTexts(names));
  }
  return {};
}

void AddEval(const CommandLine& line) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* eval = line.app.add_subcommand(
      "eval", "Score generated motions of any program with the papers' metrics, or fits with their ground truth");
  eval->add_option("--protocol", arguments->protocol,
                   "scoring protocol: " + JoinTexts(ProtocolNames()) + ", or a YAML file; needed without --fits");
  AddRepeated(eval, "--generated", arguments->generated,
              "motions to score, a file or a folder: a dataset or MotionSet of mocurate; .npy of (motions, frames, "
              "joints, 3) or (motions, frames, 3 joints); MDM's results.npy; ACTOR's generation.npy; a folder of "
              "one motion per file; BVH; AMASS .npz. NAME=PATH names the row; may be repeated");
  AddRepeated(eval, "--labels", arguments->labels,
              "labels of the generated motions: .npy of class indices or names, .csv of 'name,label' lines, or a "
              "label per line, in the order of the motions or of the folder's file names; once for all sets, or once "
              "for each. Default: file names of a folder that begin with a class");
  AddRepeated(
      eval, "--lengths", arguments->lengths,
      "numbers of frames of the generated motions, which are cut to them: a text of one number a line, or .npy, in "
      "the order of the motions; once for all sets, or once for each");
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
  AddRepeated(eval, "--tolerate", arguments->tolerate,
              "code of a finding for which a run refuses or excludes clips, to go on with such clips; may be repeated");
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
                   "extractor instead of the protocol's: a name of configs/extractors, a YAML file, a checkpoint, or a "
                   "folder of export --layout extractor");
  CLI::Option* dose_response =
      eval->add_option("--dose-response", arguments->damaged_real,
                       "instead of --generated: real motions (as for --real) to damage by known doses; tables and "
                       "a plot show each metric's response (default: the dataset of --run)")
          ->expected(0, 1);
  std::string damages;
  for (const DamageInfo& info : Damages()) damages += (damages.empty() ? "" : ", ") + std::string(info.name);
  AddRepeated(eval, "--doses", arguments->doses, "a damage and its doses, of: " + damages + "; may be repeated")
      ->type_name("NAME=DOSE,...");
  eval->add_option("--seed", arguments->seed, "seed of the damages (default 1)");
  CLI::Option* fits = AddRepeated(eval, "--fits", arguments->fits,
                                  "instead of --generated: fits to compare with --truth, a dataset or a run folder. "
                                  "NAME=PATH names the row; may be repeated");
  CLI::Option* truth =
      eval->add_option("--truth", arguments->truth,
                       "ground truth of --fits by clip id, in the world of their source: the folder truth of mocurate "
                       "synthesize or a file of it, or a dataset");
  CLI::Option* output =
      eval->add_option("-o,--output", arguments->output, "folder for features/SET.h5, tables/ and metrics.json");
  AddAssignments(eval, arguments->assignments,
                 "override an option of the protocol or its extractor, e.g. --set variant=released, "
                 "--set extractor.generated_root=first_frame");
  AddJobCount(eval, arguments->jobs);
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
      "  mocurate eval --protocol own --run runs/kard --dose-response --doses jitter_mm=1,5,20 -o doses\n"
      "  mocurate eval --fits fits.h5 --truth studio_tracks/truth -o scores");
  const std::vector<const CLI::Option*> of_fits = {fits, truth, output, eval->get_option("--jobs")};
  const auto call = [dose_response, eval, of_fits](CommonArguments& common, EvalArguments& given) {
    given.dose_response = dose_response->count() > 0;
    if (Status alone = given.fits.empty() ? Status() : CheckAlone(*eval, "--fits", of_fits); !alone) return alone;
    return EvalVerb(common, given);
  };
  line.Calls(eval, call, arguments);
}

}  // namespace

void AddMotionVerbs(const CommandLine& line) {
  for (const auto add : {AddExport, AddGenerate, AddDraw, AddView, AddReproduce, AddEval}) add(line);
}

}  // namespace mocurate
