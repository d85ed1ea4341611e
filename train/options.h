#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/motion/action_parts.h"

namespace mocurate {

/// Kind of a network. A variant in a paper's table is an option of one kind, not another kind.
enum class NetworkKind {
  kGruRecogniser,
  kStGcn,
  kAction2Motion,
  kCondGru,
  kActMoCoGan,
  kTwoStageGan,
  kActor,
  kMacvae,
  kSsmct
};

/// Whether networks of the kind generate motions; the others recognise them.
bool GeneratesMotions(NetworkKind kind);

/// How a clip is converted to a window of a fixed number of frames.
enum class RecogniserInputKind {
  kResample,
  kCrop,
  kWhole,  ///< the clip as it is; of joints behind its end zeros less the first root, as MultiAct has it
};
/// Output of a recurrent recogniser that is used: of the last frame, padding included, or of the last frame of the
/// clip.
enum class ReadOutChoice { kLastFrame, kLastValid };
enum class InitialHidden { kZero, kNormal };

/// Random changes of training clips, drawn each time a clip is read. All zero: none, as in every paper's generator.
struct AugmentationOptions {
  double yaw_rad = 0.0;  ///< rotation about the vertical, uniform in +-
  double scale = 0.0;    ///< size, uniform in 1 +-
  double noise_m = 0.0;  ///< standard deviation of every coordinate
  double crop = 0.0;     ///< largest share of frames cut, split between both ends
  double warp = 0.0;     ///< largest relative change of speed
  bool mirror = false;   ///< half of the clips (exchanges left and right)
  void Declare(OptionVisitor& v);
};

/// The training clips of a dataset, and how batches are formed.
struct TrainingDataOptions {
  std::string split;       ///< name of the dataset's split; empty: the first one, or all clips if there is none
  bool all_clips = false;  ///< train on every clip, as released (no held-out part)
  double fraction = 1.0;   ///< share of the training clips of each class; smaller fractions are subsets of larger ones
  bool balance = false;    ///< every class equally often, whatever its number of clips
  RecogniserInputKind input = RecogniserInputKind::kCrop;  ///< crop: the papers' windows; resample: whole clips
  bool include_last_start = false;                         ///< of a crop; released: never (a2m_actor.md F15)
  ClipPart part = ClipPart::kWhole;  ///< of samples of MultiAct: the whole, or the transition or action alone
  std::int64_t frames = 60;
  std::int64_t longest_frames = 0;  ///< maximum length of random windows; 0: all have `frames`
  AugmentationOptions augmentation;
  void Declare(OptionVisitor& v, NetworkKind kind);
};

enum class TrainDevice { kCpu, kCuda };

/// Length and steps of a training.
struct LearningOptions {
  std::int64_t iterations = 50;  ///< steps; recognisers count epochs instead
  std::int64_t until = 0;        ///< stop after this many; 0: all
  std::int64_t planned = 0;      ///< iterations before a limit or a budget reduced them, not an option; 0: unchanged
  std::int64_t batch = 128;      ///< clips per step; fewer where the training part is smaller
  std::int64_t shards = 2;       ///< parts of a batch whose gradients are summed in order, one core each
  double learning_rate = 2e-4;
  double weight_decay = 1e-5;
  double gradient_clip = 0.0;      ///< largest norm of a step's gradient; 0: no bound
  std::int64_t save_every = 50;    ///< steps between two saved states
  std::vector<double> samples_at;  ///< steps whose network is saved and scored as a row of its own
  TrainDevice device = TrainDevice::kCpu;
  std::filesystem::path start_from;  ///< initial weights; empty: random
  std::string start_from_network;    ///< network of the job that provides them; or empty
  std::filesystem::path weights;     ///< of a network trained elsewhere, used unchanged; empty: it is trained
  void Declare(OptionVisitor& v, NetworkKind kind);
};

/// Action2Motion's GRU classifier (a2m_actor.md D.1); MultiAct's has 4 layers of 256 (multiact.md E).
struct GruRecogniserOptions {
  std::int64_t hidden = 128;
  std::int64_t layers = 2;
  std::int64_t epochs = 60;
  double label_smoothing = 0.0;
  bool standardise = true;  ///< train on standardised numbers, folded into the weights afterwards
  bool anneal = true;       ///< learning rate decays to zero along half a cosine
  InitialHidden initial_hidden = InitialHidden::kZero;
  ReadOutChoice read_out = ReadOutChoice::kLastFrame;
  std::int64_t check_every = 5;      ///< epochs between two checks on the validation fold
  bool refit = true;                 ///< train again on all training clips for the chosen number of epochs
  double smallest_validation = 0.1;  ///< without a validation part and persons: share of the clips held out
  bool released = false;             ///< nothing is held out and the last epoch is kept (a2m_actor.md D.1)
  void Declare(OptionVisitor& v);
  bool selects() const { return !released; }
  bool refits() const { return refit && !released; }
  /// The options of training length and data, which other recognisers share.
  void DeclareEpochs(OptionVisitor& v);
};

enum class Protocol { kReleased, kPaper };
enum class FeedbackChoice { kProtocol, kRaw, kJoints };
enum class TimeChoice { kProtocol, kNone, kReleased, kPaper };
enum class LossChoice { kProtocol, kMean, kSquaredNorm };
enum class LieExpChoice { kReleased, kExact };

/// Action2Motion (a2m_actor.md B) with and without Lie.
struct Action2MotionOptions {
  bool lie = true;
  Protocol protocol = Protocol::kReleased;
  std::optional<double> self_feed_probability;  ///< absent: 0.6 released, 0.4 paper
  FeedbackChoice feedback = FeedbackChoice::kProtocol;
  TimeChoice time_counter = TimeChoice::kProtocol;
  LossChoice reconstruction = LossChoice::kProtocol;
  std::optional<double> kl_weight;  ///< absent: 0.001 with Lie, 0.0001 without (released); 0.01 (paper, HumanAct12)
  LieExpChoice lie_exp = LieExpChoice::kReleased;
  std::int64_t hidden = 128;
  std::int64_t latent = 30;
  void Declare(OptionVisitor& v);
};

/// Scored output of CondGRU: the rollout, or that of the released evaluation, a real pose followed by zeros
/// (a2m_actor.md F4).
enum class CondGruEvaluation { kRollout, kReleasedZeros };

/// Conditioned GRU (a2m_actor.md B.9).
struct CondGruOptions {
  std::int64_t hidden = 128;
  double teacher_forcing = 0.5;  ///< probability of teacher forcing for a sequence
  CondGruEvaluation evaluation = CondGruEvaluation::kRollout;
  void Declare(OptionVisitor& v);
};

/// Act-MoCoGAN (a2m_actor.md B.9). Which of its switches the paper used is not recorded.
struct ActMoCoGanOptions {
  bool lie = false;
  std::int64_t hidden = 128;
  std::int64_t latent = 30;
  double category_weight = 0.7;    ///< of the class in the generator's loss
  double pose_weight = 0.5;        ///< of the pose discriminator; 0: none
  double smoothness_weight = 0.0;  ///< of frame differences; 0.3 where the released switch is on
  std::int64_t motion_batch = 0;   ///< motions of a batch that the motion discriminator judges; 0: all (released: 3)
  void Declare(OptionVisitor& v);
};

/// Two-stage GAN (a2m_actor.md B.9): poses first, then sequences of their latents, both by Wasserstein critics.
struct TwoStageGanOptions {
  std::int64_t latent = 30;
  std::int64_t pose_hidden = 128;
  std::int64_t motion_hidden = 256;
  double pose_share = 0.5;        ///< of the iterations, for the pose generator
  std::int64_t critic_steps = 5;  ///< critic steps per generator step
  double weight_clip = 0.01;      ///< largest weight of a critic
  double gradient_penalty = 0.0;  ///< weight of the penalty that replaces the clipping; 0: weights are clipped
  void Declare(OptionVisitor& v);
};

/// ACTOR's representation of a frame (a2m_actor.md C.1): the rotation of each joint, or joints.
enum class PoseChoice { kRotation6D, kMatrix, kQuaternion, kAxisAngle, kJoints };
/// Encoder and decoder of ACTOR and its ablations (a2m_actor.md C.2, C.6).
enum class ActorCoders { kTransformer, kGru, kFullyConnected, kAutoregressive };
/// Source of mean and variance: two tokens of the class, or the mean over the frames.
enum class DistributionChoice { kTokens, kAverage };
/// Class input of the decoder: a bias added to the latent, the one-hot class in a layer with it, or the bias as a
/// second memory entry.
enum class ConditionChoice { kBias, kOneHot, kConcatenated };

/// ACTOR (a2m_actor.md C).
struct ActorOptions {
  ActorCoders coders = ActorCoders::kTransformer;
  DistributionChoice distribution = DistributionChoice::kTokens;
  ConditionChoice condition = ConditionChoice::kBias;
  PoseChoice pose = PoseChoice::kRotation6D;
  bool translation = true;  ///< the root's position is an additional row
  std::int64_t latent = 256;
  std::int64_t layers = 8;
  std::int64_t heads = 4;
  std::int64_t feed_forward = 1024;
  double dropout = 0.1;
  double pose_weight = 1.0;       ///< of the loss on a frame's values
  double joint_weight = 1.0;      ///< of the loss on joints
  double vertex_weight = 0.0;     ///< of the loss on the vertices of `body`
  bool body_translation = false;  ///< losses on joints and vertices include the root's translation
  double kl_weight = 1e-5;
  bool kl_mean = false;  ///< KL divided by the batch; released: its sum (a2m_actor.md F11)
  std::filesystem::path body;
  void Declare(OptionVisitor& v);
  bool NeedsRotations() const { return pose != PoseChoice::kJoints; }
};

/// Coder of MACVAE's frames: its transformers, or the ablations of MultiAct's Table B.
enum class MacvaeBackbone { kTransformer, kLstm, kGru, kMlp };
/// Pose of each sample, by the last frame of its previous motion (multiact.md B): facing +z at the origin; with its
/// root's rotation inverted; as in the source.
enum class CanonicalChoice { kFaceFront, kZero, kNone };
/// Frame after the action in the postprocessor's convolution: of the released index, which is no frame of the motion,
/// or the last one (multiact.md H7).
enum class FillChoice { kProtocol, kReleased, kLast };
/// Layout of the previous motion's rotations in the postprocessor: rows, where all others are columns, or columns
/// (multiact.md H6).
enum class LayoutChoice { kProtocol, kReleased, kColumns };
/// Points of the loss instead of SMPL-H's vertices: joints with three points 5 cm along each joint's axes, joints only,
/// or the vertices of `body`.
enum class PointChoice { kMarkers, kJoints, kVertices };

/// MACVAE of MultiAct (multiact.md C).
struct MacvaeOptions {
  Protocol protocol = Protocol::kReleased;
  MacvaeBackbone backbone = MacvaeBackbone::kTransformer;
  CanonicalChoice canonical = CanonicalChoice::kFaceFront;
  bool separate_latents = true;     ///< of transition and action; else one for both
  bool action_to_previous = false;  ///< PrevNet reads the action too
  bool whole_previous = false;      ///< PrevNet reads the whole previous motion
  std::int64_t previous_frames = 4;
  bool postprocessor = true;
  FillChoice fill = FillChoice::kProtocol;
  LayoutChoice layout = LayoutChoice::kProtocol;
  PointChoice points = PointChoice::kMarkers;
  std::int64_t vocabulary = 0;  ///< rows of the word tables; 0: as many as the set has
  std::int64_t width = 512;
  std::int64_t layers = 8;
  std::int64_t heads = 4;
  std::int64_t feed_forward = 2048;
  double dropout = 0.1;
  double pose_weight = 1.0;
  double point_weight = 1.0;
  double acceleration_weight = 1.0;
  double kl_weight = 1e-5;
  std::filesystem::path body;
  void Declare(OptionVisitor& v);

  bool released() const { return protocol == Protocol::kReleased; }
  bool fills_last() const { return fill == FillChoice::kLast || (fill == FillChoice::kProtocol && !released()); }
  bool one_layout() const {
    return layout == LayoutChoice::kColumns || (layout == LayoutChoice::kProtocol && !released());
  }
};

/// Stand-in of SSMCT (multiact.md F.2), of which no code and no sizes are published.
struct SsmctOptions {
  std::int64_t width = 512;
  std::int64_t layers = 8;
  std::int64_t heads = 4;
  std::int64_t feed_forward = 2048;
  double dropout = 0.1;
  double pose_weight = 1.0;   ///< of the loss on a frame's values
  double joint_weight = 1.0;  ///< of the loss on joints
  void Declare(OptionVisitor& v);
};

/// ST-GCN (a2m_actor.md D.1).
struct StGcnOptions {
  bool global_orientation = true;  ///< the root's rotation is read too
  void Declare(OptionVisitor& v);
};

/// Training clips: the dataset, the same clips before fitting, or motions that a network of the job generates from its
/// training clips (a2m_actor.md D.9).
enum class TrainingSetChoice { kDataset, kUnfitted, kDenoised, kInterpolated, kGenerated };

/// How a network remakes a clip: encoded and decoded; with the latent interpolated towards that of another clip of its
/// class; or generated from its class and length.
enum class RemakeRule { kDenoise, kInterpolate, kGenerate };
/// "denoised", "interpolated", "generated"
const char* Name(RemakeRule rule);

/// How a network of the job makes them; nothing where none does.
std::optional<RemakeRule> RuleOf(TrainingSetChoice choice);

/// Options of the stage `generate` with clips instead of requests.
struct RemakeOptions {
  std::int64_t seed = 1;
  RemakeRule rule = RemakeRule::kDenoise;
  /// Uses windows (TrainingWindows) of the network's training clips, not all clips.
  bool training_windows = false;
  void Declare(OptionVisitor& v);
};

/// Options of the stage `generate` where its requests are scripts.
struct LongMotionOptions {
  bool snap = false;           ///< a continuation begins at the last frame's position and heading
  bool align = false;          ///< rotate and move joined motions to the end of the one before
  bool keep_previous = false;  ///< the answer begins with the motion that it continues
  void Declare(OptionVisitor& v);
};

/// One network of a job: `train.networks: [{name, kind, ...}]`. It has only the options of its kind.
struct NetworkOptions {
  std::string name;  ///< of its row and its checkpoints
  NetworkKind kind = NetworkKind::kAction2Motion;
  bool enabled = true;           ///< false: not trained; excludes it from a set of a table
  std::vector<double> seeds{1};  ///< of initial weights, order, crops and noise; one network each
  TrainingSetChoice trained_on = TrainingSetChoice::kDataset;
  std::string generator;    ///< network of the job that generates its training motions; else empty
  double made_share = 1.0;  ///< share of generated clips in each batch; the rest is from the dataset
  TrainingDataOptions data;
  LearningOptions learning;
  GruRecogniserOptions recogniser;
  Action2MotionOptions action2motion;
  CondGruOptions cond_gru;
  ActMoCoGanOptions act_mocogan;
  TwoStageGanOptions two_stage_gan;
  ActorOptions actor;
  MacvaeOptions macvae;
  SsmctOptions ssmct;
  StGcnOptions st_gcn;

  /// With the defaults of its kind.
  explicit NetworkOptions(NetworkKind kind = NetworkKind::kAction2Motion);
  void Declare(OptionVisitor& v);
  /// Of one network: the first of `seeds`.
  std::uint64_t seed() const { return static_cast<std::uint64_t>(seeds.front()); }
  bool recognises() const { return !GeneratesMotions(kind); }
  bool NeedsRotations() const;
  /// Whether it is trained on the three parts of samples.
  bool NeedsParts() const;
  /// Whether a loss is on the vertices of a body; its file, and the option that names it.
  bool NeedsBody() const;
  std::filesystem::path& body() { return kind == NetworkKind::kMacvae ? macvae.body : actor.body; }
  const std::filesystem::path& body() const { return kind == NetworkKind::kMacvae ? macvae.body : actor.body; }

 private:
  NetworkKind defaults_of_;
};

}  // namespace mocurate
