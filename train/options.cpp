#include "train/options.h"
#include "train/stages.h"

namespace mocurate {

bool GeneratesMotions(NetworkKind kind) { return kind != NetworkKind::kGruRecogniser && kind != NetworkKind::kStGcn; }

void AugmentationOptions::Declare(OptionVisitor& v) {
  v.Number("yaw", yaw_rad, Unit::kRadian, {0.0, 3.2}, "rotation about the vertical, uniform in plus or minus this");
  v.Number("scale", scale, Unit::kNone, {0.0, 0.5}, "size, uniform in 1 plus or minus this");
  v.Number("noise", noise_m, Unit::kMetre, {0.0, 0.5}, "standard deviation added to every coordinate");
  v.Number("crop", crop, Unit::kNone, {0.0, 0.9}, "largest share of a clip's frames cut off at its ends");
  v.Number("warp", warp, Unit::kNone, {0.0, 0.9}, "largest relative change of speed inside a clip");
  v.Bool("mirror", mirror, "mirror half of the clips (exchanges left and right: only for actions without a side)");
}

void TrainingDataOptions::Declare(OptionVisitor& v, NetworkKind kind) {
  const bool parts = kind == NetworkKind::kMacvae || kind == NetworkKind::kSsmct;
  const bool rotations = kind == NetworkKind::kStGcn || kind == NetworkKind::kActor || parts;
  v.Text("split", split, "split of the dataset to train on; empty: the first split, or all clips where there is none");
  v.Bool("all_clips", all_clips, "train on every clip, as in the released code");
  v.Number("fraction", fraction, Unit::kNone, {0.01, 1.0},
           "share of the training clips of each class; a smaller fraction is a subset of a larger one");
  v.Bool("balance", balance, "draw every class equally often, whatever its number of clips");
  if (!rotations) {
    v.Choice(
        "input", input,
        {{"resample", RecogniserInputKind::kResample},
         {"crop", RecogniserInputKind::kCrop},
         {"whole", RecogniserInputKind::kWhole}},
        "windows of consecutive frames (as published), whole clips resampled to `frames`, or whole clips padded to "
        "`frames` (MultiAct)");
  } else if (kind == NetworkKind::kActor) {
    v.Choice("input", input, {{"crop", RecogniserInputKind::kCrop}, {"whole", RecogniserInputKind::kWhole}},
             "windows of consecutive frames, or whole clips of at most `frames`");
  }
  if (!parts) {
    v.Choice("part", part,
             {{"whole", ClipPart::kWhole}, {"transition", ClipPart::kTransition}, {"action", ClipPart::kAction}},
             "part of samples of two actions: all, only the transition, or only the second action (MultiAct)");
    v.Bool("include_last_start", include_last_start,
           "allow a crop to begin at the last possible frame (released: never)");
  }
  v.Integer("frames", frames, {2.0, 1000.0}, "frames of a training window; whole clips are padded to it");
  if (kind == NetworkKind::kActor) {
    v.Integer("longest_frames", longest_frames, {0.0, 4000.0},
              "maximum length of a window: lengths are drawn between `frames` and this; 0: all have `frames`");
  }
  if (!rotations) v.Group("augmentation", augmentation, "random changes of the training clips");
}

void LearningOptions::Declare(OptionVisitor& v, NetworkKind kind) {
  v.Integer("batch", batch, {1.0, 4096.0}, "clips per step; fewer when the training part is smaller");
  if (kind != NetworkKind::kStGcn && kind != NetworkKind::kSsmct && kind != NetworkKind::kMacvae)
    v.Integer("shards", shards, {1.0, 64.0},
              "parts of a batch, one core each; gradients are summed in fixed order, so results do not depend on the "
              "number of cores");
  v.Number("learning_rate", learning_rate, Unit::kNone, {1e-8, 1.0}, "learning rate of the optimiser");
  v.Number("weight_decay", weight_decay, Unit::kNone, {0.0, 1.0}, "L2 term of Adam");
  v.Number("gradient_clip", gradient_clip, Unit::kNone, {0.0, 1e6}, "gradient clipping: maximum norm; 0: no clipping");
  v.Integer("save_every", save_every, {1.0, 1e8}, "steps between two saved states, from which a killed run resumes");
  v.Choice("device", device, {{"cpu", TrainDevice::kCpu}, {"cuda", TrainDevice::kCuda}},
           "device of the training; cuda needs a libtorch with CUDA");
  v.Path("start_from", start_from,
         "start from the weights of this file with a new optimiser (formats as for `weights`)");
  v.Path("weights", weights,
         "use the weights of this file (released .tar or .pth, .h5, .safetensors) without training; options as they "
         "were trained");
  if (!GeneratesMotions(kind)) return;
  v.Text("start_from_network", start_from_network,
         "start from the weights of this network (listed earlier in train.networks) with a new optimiser");
  v.Integer("iterations", iterations, {1.0, 1e8}, "training steps");
  v.Integer("until", until, {0.0, 1e8}, "stop after this many steps; 0: all");
  v.Numbers("samples_at", samples_at, Unit::kNone, {1.0, 1e8},
            "steps at which the network is saved and scored as a row NAME@STEP");
}

void GruRecogniserOptions::Declare(OptionVisitor& v) {
  v.Integer("layers", layers, {1.0, 8.0}, "GRU layers of the network");
  v.Integer("hidden", hidden, {4.0, 1024.0}, "size of the recurrent state");
  v.Number("label_smoothing", label_smoothing, Unit::kNone, {0.0, 0.5}, "label smoothing of the cross entropy");
  v.Bool("standardise", standardise, "train on standardised inputs; the stored weights read plain joints");
  v.Choice("initial_hidden", initial_hidden, {{"zero", InitialHidden::kZero}, {"normal", InitialHidden::kNormal}},
           "initial recurrent state while training (released: normal)");
  v.Choice("read_out", read_out, {{"last_frame", ReadOutChoice::kLastFrame}, {"last_valid", ReadOutChoice::kLastValid}},
           "output used: of the last frame, padding included (released), or of the clip's last frame");
  DeclareEpochs(v);
}

void GruRecogniserOptions::DeclareEpochs(OptionVisitor& v) {
  v.Integer("epochs", epochs, {1.0, 100000.0}, "passes over the training clips");
  v.Bool("anneal", anneal,
         "decay the learning rate to zero along half a cosine; then all epochs are trained, no best one is chosen");
  v.Integer("check_every", check_every, {1.0, 100000.0}, "epochs between checks on the validation fold");
  v.Bool("refit", refit, "train again on all training clips for the chosen number of epochs");
  v.Number("smallest_validation", smallest_validation, Unit::kNone, {0.01, 0.5},
           "share of the training clips held out when the split has no validation part and too few persons");
  v.Bool("released", released,
         "hold out no clip, train all epochs and keep the last, as the released codes do; then no validation score "
         "shows how well it does");
}

void Action2MotionOptions::Declare(OptionVisitor& v) {
  v.Bool("lie", lie, "decode rotations and compute joints by forward kinematics; false: decode joints");
  v.Choice("protocol", protocol, {{"released", Protocol::kReleased}, {"paper", Protocol::kPaper}},
           "rules where code and paper differ; the options below override single ones");
  v.OptionalNumber("self_feed_probability", self_feed_probability, Unit::kNone, {0.0, 1.0},
                   "probability that a step feeds back the model's own prediction (released 0.6, paper 0.4)");
  v.Choice(
      "feedback", feedback,
      {{"protocol", FeedbackChoice::kProtocol}, {"raw", FeedbackChoice::kRaw}, {"joints", FeedbackChoice::kJoints}},
      "prediction that is fed back: the raw output (released) or joints (paper)");
  v.Choice("time_counter", time_counter,
           {{"protocol", TimeChoice::kProtocol},
            {"none", TimeChoice::kNone},
            {"released", TimeChoice::kReleased},
            {"paper", TimeChoice::kPaper}},
           "i/(T-1) as released, (i+1)/T as in the paper, or none (released without Lie)");
  v.Choice(
      "reconstruction", reconstruction,
      {{"protocol", LossChoice::kProtocol}, {"mean", LossChoice::kMean}, {"squared_norm", LossChoice::kSquaredNorm}},
      "mean over all values (released) or squared norm per pose (paper)");
  v.OptionalNumber("kl_weight", kl_weight, Unit::kNone, {0.0, 100.0},
                   "weight of the KL term (released 0.001 with Lie, 0.0001 without; paper 0.01)");
  v.Choice("lie_exp", lie_exp, {{"released", LieExpChoice::kReleased}, {"exact", LieExpChoice::kExact}},
           "whether angles below 0.01 rad are floored, as released");
  v.Integer("hidden", hidden, {4.0, 1024.0}, "size of the recurrent states");
  v.Integer("latent", latent, {1.0, 1024.0}, "size of the noise per frame");
}

void CondGruOptions::Declare(OptionVisitor& v) {
  v.Integer("hidden", hidden, {4.0, 1024.0}, "size of the recurrent state");
  v.Number("teacher_forcing", teacher_forcing, Unit::kNone, {0.0, 1.0},
           "probability of teacher forcing for a sequence");
  v.Choice("evaluation", evaluation,
           {{"rollout", CondGruEvaluation::kRollout}, {"released_zeros", CondGruEvaluation::kReleasedZeros}},
           "scored output: a rollout, or a real pose followed by zeros, as in the published rows (F4)");
}

void ActMoCoGanOptions::Declare(OptionVisitor& v) {
  v.Bool("lie", lie, "generate rotations and compute joints by forward kinematics; false: generate joints");
  v.Integer("hidden", hidden, {8.0, 1024.0}, "size of the recurrent states");
  v.Integer("latent", latent, {1.0, 1024.0}, "size of the noise per frame");
  v.Number("category_weight", category_weight, Unit::kNone, {0.0, 100.0},
           "weight of the class in the generator's loss");
  v.Number("pose_weight", pose_weight, Unit::kNone, {0.0, 100.0}, "weight of the pose discriminator; 0: none");
  v.Number("smoothness_weight", smoothness_weight, Unit::kNone, {0.0, 100.0},
           "weight of the differences between frames (0.3 with the released switch)");
  v.Integer(
      "motion_batch", motion_batch, {0.0, 1000.0},
      "motions of a batch that the motion discriminator judges; 0: all (released: 3, of 20 frames, with 30 poses)");
}

void TwoStageGanOptions::Declare(OptionVisitor& v) {
  v.Integer("latent", latent, {1.0, 1024.0}, "size of a pose's latent");
  v.Integer("pose_hidden", pose_hidden, {4.0, 1024.0}, "width of the pose generator and its critic");
  v.Integer("motion_hidden", motion_hidden, {4.0, 1024.0}, "width of the motion generator and its critic");
  v.Number("pose_share", pose_share, Unit::kNone, {0.01, 0.99}, "share of the iterations for the pose generator");
  v.Integer("critic_steps", critic_steps, {1.0, 100.0}, "critic steps per generator step");
  v.Number("weight_clip", weight_clip, Unit::kNone, {1e-6, 10.0}, "largest absolute weight of a critic");
  v.Number("gradient_penalty", gradient_penalty, Unit::kNone, {0.0, 1000.0},
           "weight of a gradient penalty instead of clipped critics (10 in Gulrajani et al. 2017); 0: clipped");
}

void ActorOptions::Declare(OptionVisitor& v) {
  v.Choice("coders", coders,
           {{"transformer", ActorCoders::kTransformer},
            {"gru", ActorCoders::kGru},
            {"fully_connected", ActorCoders::kFullyConnected},
            {"autoregressive", ActorCoders::kAutoregressive}},
           "encoder and decoder: the paper's, or an ablation (Table 2)");
  v.Choice("distribution", distribution,
           {{"tokens", DistributionChoice::kTokens}, {"average", DistributionChoice::kAverage}},
           "mean and variance from two tokens of the class, or from the mean over the frames (Table 2 b)");
  v.Choice("condition", condition,
           {{"bias", ConditionChoice::kBias},
            {"one_hot", ConditionChoice::kOneHot},
            {"concatenated", ConditionChoice::kConcatenated}},
           "class input of the decoder: a bias, its one-hot code (Table 2 c), or the bias as a second memory entry");
  v.Choice("pose", pose,
           {{"rotation_6d", PoseChoice::kRotation6D},
            {"matrix", PoseChoice::kMatrix},
            {"quaternion", PoseChoice::kQuaternion},
            {"axis_angle", PoseChoice::kAxisAngle},
            {"joints", PoseChoice::kJoints}},
           "representation of a frame; joints need no rotations in the dataset");
  v.Bool("translation", translation, "encode the root's position as an additional row");
  v.Integer("latent", latent, {4.0, 4096.0}, "width of the network and of its latent; a multiple of `heads`");
  v.Integer("layers", layers, {1.0, 64.0}, "layers of the encoder and of the decoder each");
  v.Integer("heads", heads, {1.0, 64.0}, "attention heads");
  v.Integer("feed_forward", feed_forward, {4.0, 16384.0}, "width of the feed-forward layer");
  v.Number("dropout", dropout, Unit::kNone, {0.0, 0.9}, "dropout probability in training");
  v.Number("pose_weight", pose_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on a frame's values");
  v.Number("joint_weight", joint_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on joints (forward kinematics)");
  v.Number("vertex_weight", vertex_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on the vertices of `body`");
  v.Bool("body_translation", body_translation, "include the root's translation in the losses on joints and vertices");
  v.Number("kl_weight", kl_weight, Unit::kNone, {0.0, 100.0}, "weight of the KL term");
  v.Bool("kl_mean", kl_mean,
         "divide the KL term by the batch size (released: the sum, whose weight grows with the batch)");
  v.Path("body", body, "skinned body of the vertex loss: SMPL's file, or body_cc0.h5");
}

void MacvaeOptions::Declare(OptionVisitor& v) {
  v.Choice("protocol", protocol, {{"released", Protocol::kReleased}, {"paper", Protocol::kPaper}},
           "rules where code and paper differ: positions, representation of a frame, posterior and losses");
  v.Choice("backbone", backbone,
           {{"transformer", MacvaeBackbone::kTransformer},
            {"lstm", MacvaeBackbone::kLstm},
            {"gru", MacvaeBackbone::kGru},
            {"mlp", MacvaeBackbone::kMlp}},
           "coder of the frames: the paper's, or those of Table B");
  v.Choice(
      "canonical", canonical,
      {{"face_front", CanonicalChoice::kFaceFront}, {"zero", CanonicalChoice::kZero}, {"none", CanonicalChoice::kNone}},
      "pose of the last frame of the previous motion: at the origin facing +z; with its root's rotation inverted; "
      "as in the source (Table 1)");
  v.Bool("separate_latents", separate_latents, "separate latents of transition and action; else one for both");
  v.Bool("action_to_previous", action_to_previous, "give PrevNet the action too (Table 1)");
  v.Bool("whole_previous", whole_previous, "PrevNet reads the whole previous motion (Table 1)");
  v.Integer("previous_frames", previous_frames, {1.0, 100.0}, "last frames of the previous motion that PrevNet reads");
  v.Bool("postprocessor", postprocessor, "smooth by a convolution over five frames (without it: no published row)");
  v.Choice("fill", fill,
           {{"protocol", FillChoice::kProtocol}, {"released", FillChoice::kReleased}, {"last", FillChoice::kLast}},
           "frame after the action that the convolution reads: of the released index, or the last one");
  v.Choice("layout", layout,
           {{"protocol", LayoutChoice::kProtocol},
            {"released", LayoutChoice::kReleased},
            {"columns", LayoutChoice::kColumns}},
           "6-D rotations of the previous motion in the postprocessor: rows as released, or columns like all others");
  v.Choice(
      "points", points,
      {{"markers", PointChoice::kMarkers}, {"joints", PointChoice::kJoints}, {"vertices", PointChoice::kVertices}},
      "points of the loss: joints with three points 5 cm along each joint's axes, joints, or the vertices of `body`");
  v.Integer("vocabulary", vocabulary, {0.0, 1e6}, "rows of the word tables; 0: as many as the set has (released 5396)");
  v.Integer("width", width, {4.0, 4096.0}, "width of the network and of its latents; a multiple of `heads`");
  v.Integer("layers", layers, {1.0, 64.0}, "layers of the encoder and of the decoder each");
  v.Integer("heads", heads, {1.0, 64.0}, "attention heads");
  v.Integer("feed_forward", feed_forward, {4.0, 16384.0}, "width of the feed-forward layer");
  v.Number("dropout", dropout, Unit::kNone, {0.0, 0.9}, "dropout probability in training");
  v.Number("pose_weight", pose_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on a frame's values");
  v.Number("point_weight", point_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on `points`");
  v.Number("acceleration_weight", acceleration_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on accelerations");
  v.Number("kl_weight", kl_weight, Unit::kNone, {0.0, 100.0}, "weight of the KL term");
  v.Path("body", body, "skinned body of the vertex loss: SMPL's file, or body_cc0.h5");
}

void SsmctOptions::Declare(OptionVisitor& v) {
  v.Integer("width", width, {4.0, 4096.0}, "width of the network; a multiple of `heads`");
  v.Integer("layers", layers, {1.0, 64.0}, "layers of the encoder");
  v.Integer("heads", heads, {1.0, 64.0}, "attention heads");
  v.Integer("feed_forward", feed_forward, {4.0, 16384.0}, "width of the feed-forward layer");
  v.Number("dropout", dropout, Unit::kNone, {0.0, 0.9}, "dropout probability in training");
  v.Number("pose_weight", pose_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on a frame's values");
  v.Number("joint_weight", joint_weight, Unit::kNone, {0.0, 1e6}, "weight of the loss on joints (forward kinematics)");
}

void StGcnOptions::Declare(OptionVisitor& v) {
  v.Bool("global_orientation", global_orientation, "read the root's rotation too");
}

NetworkOptions::NetworkOptions(NetworkKind of) : kind(of), defaults_of_(of) {
  switch (kind) {
    case NetworkKind::kGruRecogniser:
      name = "recogniser";
      data.input = RecogniserInputKind::kResample;
      data.augmentation = {0.35, 0.1, 0.01, 0.15, 0.2, false};
      learning.batch = 32;
      learning.shards = 1;
      learning.learning_rate = 2e-3;
      learning.weight_decay = 0.0;
      learning.gradient_clip = 1.0;
      learning.save_every = 500;
      return;
    case NetworkKind::kAction2Motion:
      name = "Action2Motion";
      return;
    case NetworkKind::kCondGru:
      name = "CondGRU";
      return;
    case NetworkKind::kActMoCoGan:
      name = "Act-MoCoGAN";
      return;
    case NetworkKind::kTwoStageGan:
      name = "Two-stage GAN";
      learning.learning_rate = 5e-5;
      learning.weight_decay = 0.0;
      return;
    case NetworkKind::kActor:
      name = "ACTOR";
      learning.batch = 20;
      learning.learning_rate = 1e-4;
      learning.weight_decay = 0.01;
      return;
    case NetworkKind::kMacvae:
      name = "MACVAE";
      data.frames = 120;
      learning.iterations = 85800;  // 1,300 epochs of 1,060 samples
      learning.batch = 16;
      learning.shards = 1;  // batch statistics are of the whole batch
      learning.learning_rate = 5e-5;
      learning.weight_decay = 0.01;
      learning.save_every = 500;
      return;
    case NetworkKind::kSsmct:
      name = "SSMCT-like";
      data.frames = 120;
      learning.iterations = 85800;  // as MACVAE's
      learning.batch = 16;
      learning.shards = 1;  // means are over the transitions of the whole batch
      learning.learning_rate = 5e-5;
      learning.weight_decay = 0.01;
      learning.save_every = 500;
      return;
    case NetworkKind::kStGcn:
      name = "ST-GCN";
      learning.batch = 64;
      learning.shards = 1;  // batch statistics are of the whole batch
      learning.learning_rate = 1e-4;
      learning.weight_decay = 0.01;
      learning.save_every = 500;
      recogniser.epochs = 100;
      recogniser.standardise = recogniser.anneal = recogniser.refit = false;
      return;
  }
}

bool NetworkOptions::NeedsRotations() const {
  return kind == NetworkKind::kStGcn || kind == NetworkKind::kMacvae || kind == NetworkKind::kSsmct ||
         (kind == NetworkKind::kActor && actor.NeedsRotations());
}

bool NetworkOptions::NeedsParts() const { return kind == NetworkKind::kMacvae || kind == NetworkKind::kSsmct; }

bool NetworkOptions::NeedsBody() const {
  if (kind == NetworkKind::kMacvae) return macvae.points == PointChoice::kVertices;
  return kind == NetworkKind::kActor && actor.vertex_weight > 0.0;
}

const char* Name(RemakeRule rule) {
  const char* names[] = {"denoised", "interpolated", "generated"};
  return names[static_cast<int>(rule)];
}

std::optional<RemakeRule> RuleOf(TrainingSetChoice choice) {
  if (choice == TrainingSetChoice::kDenoised) return RemakeRule::kDenoise;
  if (choice == TrainingSetChoice::kInterpolated) return RemakeRule::kInterpolate;
  if (choice == TrainingSetChoice::kGenerated) return RemakeRule::kGenerate;
  return std::nullopt;
}

void RemakeOptions::Declare(OptionVisitor& v) {
  v.Integer("seed", seed, {}, "random seed of the draws");
  v.Choice("rule", rule,
           {{"denoise", RemakeRule::kDenoise},
            {"interpolate", RemakeRule::kInterpolate},
            {"generate", RemakeRule::kGenerate}},
           "how the network remakes a clip");
  v.Bool("training_windows", training_windows, "use windows of the network's training clips");
}

void LongMotionOptions::Declare(OptionVisitor& v) {
  v.Bool("snap", snap, "begin a continuation at the last frame's position and heading, as released");
  v.Bool("align", align, "rotate and move joined motions to the end of the one before");
  v.Bool("keep_previous", keep_previous, "begin the answer with the motion that it continues");
}

void NetworkOptions::Declare(OptionVisitor& v) {
  v.Choice("kind", kind,
           {{"gru_recogniser", NetworkKind::kGruRecogniser},
            {"action2motion", NetworkKind::kAction2Motion},
            {"cond_gru", NetworkKind::kCondGru},
            {"act_mocogan", NetworkKind::kActMoCoGan},
            {"two_stage_gan", NetworkKind::kTwoStageGan},
            {"actor", NetworkKind::kActor},
            {"macvae", NetworkKind::kMacvae},
            {"ssmct", NetworkKind::kSsmct},
            {"st_gcn", NetworkKind::kStGcn}},
           "kind of the network; the options below depend on it");
  if (kind != defaults_of_) *this = NetworkOptions(kind);
  v.Text("name", name, "name of its row in tables and of its checkpoints");
  v.Bool("enabled", enabled, "train this network; false excludes it, e.g. from one of several sets");
  v.Numbers("seeds", seeds, Unit::kNone, {0.0, 1e9}, "one network per seed");
  v.Choice("trained_on", trained_on,
           {{"dataset", TrainingSetChoice::kDataset},
            {"unfitted", TrainingSetChoice::kUnfitted},
            {"denoised", TrainingSetChoice::kDenoised},
            {"interpolated", TrainingSetChoice::kInterpolated},
            {"generated", TrainingSetChoice::kGenerated}},
           "the dataset, the same clips before fitting, or motions that `generator` makes from its training clips: "
           "encoded and decoded, between two of a class, or drawn");
  v.Text("generator", generator, "name of the actor network that generates them");
  v.Number("made_share", made_share, Unit::kNone, {0.01, 1.0},
           "share of generated clips in each batch; the rest is recorded");
  data.Declare(v, kind);
  learning.Declare(v, kind);
  switch (kind) {
    case NetworkKind::kGruRecogniser:
      return recogniser.Declare(v);
    case NetworkKind::kAction2Motion:
      return action2motion.Declare(v);
    case NetworkKind::kCondGru:
      return cond_gru.Declare(v);
    case NetworkKind::kActMoCoGan:
      return act_mocogan.Declare(v);
    case NetworkKind::kTwoStageGan:
      return two_stage_gan.Declare(v);
    case NetworkKind::kActor:
      return actor.Declare(v);
    case NetworkKind::kMacvae:
      return macvae.Declare(v);
    case NetworkKind::kSsmct:
      return ssmct.Declare(v);
    case NetworkKind::kStGcn:
      st_gcn.Declare(v);
      return recogniser.DeclareEpochs(v);
  }
}

StageDeclaration TrainDeclaration() { return {"train", 13, "mocurate-learn", WholeSetLimits()}; }

StageDeclaration GenerateDeclaration() { return {"generate", 6, "mocurate-learn", WholeSetLimits()}; }
StageDeclaration TrainCostDeclaration() { return {"train_cost", 1, "mocurate-learn", WholeSetLimits()}; }

}  // namespace mocurate
