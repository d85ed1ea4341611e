#include "train/options.h"

namespace mocurate {

void AugmentationOptions::Declare(OptionVisitor& v) {
  v.Number("yaw", yaw_rad, Unit::kRadian, {0.0, 3.2}, "rotation about the vertical, uniform in plus or minus this");
  v.Number("scale", scale, Unit::kNone, {0.0, 0.5}, "size, uniform in 1 plus or minus this");
  v.Number("noise", noise_m, Unit::kMetre, {0.0, 0.5}, "standard deviation added to every coordinate");
  v.Number("crop", crop, Unit::kNone, {0.0, 0.9}, "largest part of a clip's frames that is cut off at its ends");
  v.Number("warp", warp, Unit::kNone, {0.0, 0.9}, "largest relative change of speed inside a clip");
  v.Bool("mirror", mirror, "mirror half of the clips (changes sides: only for actions that have none)");
}

void RecogniserOptions::Declare(OptionVisitor& v) {
  v.Integer("seed", seed, {0.0, {}},
            "of initial weights, order and augmentation; a job trains one for each of its train.seeds instead");
  v.Text("split", split, "split of the dataset to train on; empty: its first one, or all clips without one");
  v.Choice("input", input, {{"resample", RecogniserInputKind::kResample}, {"crop", RecogniserInputKind::kCrop}},
           "whole clip resampled to `frames`, or the paper's crop of `frames` with repeated last pose");
  v.Integer("frames", frames, {2.0, 1000.0}, "frames that the recogniser sees");
  v.Integer("layers", layers, {1.0, 8.0}, "GRU layers of the network");
  v.Integer("hidden", hidden, {4.0, 1024.0}, "size of the recurrent state");
  v.Integer("epochs", epochs, {1.0, 100000.0}, "passes over the training clips");
  v.Integer("batch", batch, {1.0, 4096.0}, "clips per step");
  v.Number("learning_rate", learning_rate, Unit::kNone, {1e-8, 1.0}, "of Adam");
  v.Number("weight_decay", weight_decay, Unit::kNone, {0.0, 1.0}, "L2 term of Adam");
  v.Number("label_smoothing", label_smoothing, Unit::kNone, {0.0, 0.5}, "of the cross entropy");
  v.Bool("standardise", standardise,
         "train on numbers of zero mean and unit spread; the stored weights take plain joints again");
  v.Number("gradient_clip", gradient_clip, Unit::kNone, {0.0, 1e6}, "largest norm of a step's gradient; 0: no bound");
  v.Bool("anneal", anneal,
         "let the learning rate fall to zero along half a cosine; then all epochs count, no best one is chosen");
  v.Choice("initial_hidden", initial_hidden, {{"zero", InitialHidden::kZero}, {"normal", InitialHidden::kNormal}},
           "initial recurrent state while training (released: normal)");
  v.Integer("check_every", check_every, {1.0, 100000.0}, "epochs between checks on the validation fold");
  v.Bool("refit", refit, "train once more, on all training clips, for as many epochs as were chosen");
  v.Number("smallest_validation", smallest_validation, Unit::kNone, {0.01, 0.5},
           "part of the training clips held out when the split has no validation part and persons are too few");
  v.Group("augmentation", augmentation, "random changes of the training clips");
}

void GeneratorOptions::Declare(OptionVisitor& v) {
  v.Integer("seed", seed, {0.0, {}}, "of initial weights, order, crops and noise");
  v.Text("split", split, "split of the dataset to train on; empty: its first one, or all clips without one");
  v.Bool("all_clips", all_clips, "train on every clip, as the released code does");
  v.Bool("lie", lie, "decode rotations and compute joints; without it joints are decoded");
  v.Choice("protocol", protocol, {{"released", Protocol::kReleased}, {"paper", Protocol::kPaper}},
           "whose rules hold where code and paper differ; each part below can be set alone");
  v.OptionalNumber("self_feed_probability", self_feed_probability, Unit::kNone, {0.0, 1.0},
                   "chance that a step feeds the model's own prediction back (released 0.6, paper 0.4)");
  v.Choice(
      "feedback", feedback,
      {{"protocol", FeedbackChoice::kProtocol}, {"raw", FeedbackChoice::kRaw}, {"joints", FeedbackChoice::kJoints}},
      "what is fed back: the raw output (released) or joints (paper)");
  v.Choice("time_counter", time_counter,
           {{"protocol", TimeChoice::kProtocol},
            {"none", TimeChoice::kNone},
            {"released", TimeChoice::kReleased},
            {"paper", TimeChoice::kPaper}},
           "i/(T-1) as released, (i+1)/T as in the paper, or none (released without Lie)");
  v.Choice(
      "reconstruction", reconstruction,
      {{"protocol", LossChoice::kProtocol}, {"mean", LossChoice::kMean}, {"squared_norm", LossChoice::kSquaredNorm}},
      "mean over all numbers (released) or squared norm per pose (paper)");
  v.OptionalNumber("kl_weight", kl_weight, Unit::kNone, {0.0, 100.0},
                   "weight of the KL term (released 0.001 with Lie, 0.0001 without; paper 0.01)");
  v.Choice("lie_exp", lie_exp, {{"released", LieExpChoice::kReleased}, {"exact", LieExpChoice::kExact}},
           "whether angles below 0.01 rad are floored, as released");
  v.Bool("include_last_start", include_last_start, "let a crop begin at the last possible frame (released: never)");
  v.Choice("input", input, {{"resample", RecogniserInputKind::kResample}, {"crop", RecogniserInputKind::kCrop}},
           "windows of consecutive frames (as released), or whole clips resampled; as the recogniser of the table sees "
           "them");
  v.Integer("frames", frames, {2.0, 1000.0}, "frames per training crop");
  v.Integer("hidden", hidden, {4.0, 1024.0}, "size of the recurrent states");
  v.Integer("latent", latent, {1.0, 1024.0}, "size of the noise per frame");
  v.Integer("iterations", iterations, {1.0, 1e8}, "training steps");
  v.Integer("batch", batch, {1.0, 4096.0}, "clips per step; fewer when the training part is smaller");
  v.Number("learning_rate", learning_rate, Unit::kNone, {1e-8, 1.0}, "of Adam");
  v.Number("weight_decay", weight_decay, Unit::kNone, {0.0, 1.0}, "L2 term of Adam");
  v.Integer("save_every", save_every, {1.0, 1e8}, "steps between two saved states, for runs that are killed");
  v.Group("augmentation", augmentation, "random changes of the training clips");
}

StageDeclaration TrainDeclaration() { return {"train", 4, "mocurate-learn", WholeSetLimits()}; }

}  // namespace mocurate
