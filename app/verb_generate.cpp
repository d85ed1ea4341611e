#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddGenerate(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<GenerateArguments>();
  CLI::App* generate = app.add_subcommand("generate", "Generate motions with a trained network");
  generate->add_option("checkpoint", arguments->checkpoint, "checkpoint of a generator: RUN/checkpoints/NAME_SEED.h5")
      ->required();
  generate
      ->add_option("--label", arguments->labels,
                   "class, by name or index, and number of motions: sit:10; may be repeated (default: each class once)")
      ->allow_extra_args(false);
  generate->add_option("--frames", arguments->frames,
                       "frames of each motion (default: as in training); FIRST:LAST[:STEP]: each of these");
  generate
      ->add_option("--interpolate", arguments->interpolate,
                   "for each requested motion, this number of motions interpolated between two latents (kind actor)")
      ->check(CLI::Range(2, 100000));
  generate
      ->add_option("--script", arguments->scripts,
                   "motion of several actions: throw,catch:30,throw (ACTION:FRAMES), a name of "
                   "configs/scripts, or a YAML file; may be repeated (kind macvae, or actor with joined motions)")
      ->allow_extra_args(false);
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
  generate->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return GenerateVerb(common, *arguments); }; });
}

}  // namespace mocurate
