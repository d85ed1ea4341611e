#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/options.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// How a clip becomes what a recogniser sees.
enum class RecogniserInputKind { kResample, kCrop };
enum class InitialHidden { kZero, kNormal };

/// Random changes of training clips, drawn anew each time a clip is read. All zero: none (the default for generators).
struct AugmentationOptions {
  double yaw_rad = 0.0;  ///< rotation about the vertical, uniform in +-
  double scale = 0.0;    ///< size, uniform in 1 +-
  double noise_m = 0.0;  ///< standard deviation of every coordinate
  double crop = 0.0;     ///< at most this part of the frames is cut, split between both ends
  double warp = 0.0;     ///< time runs faster and slower by at most this part
  bool mirror = false;   ///< half of the time (turns left-handed actions into right-handed ones)
  void Declare(OptionVisitor& v);
};

struct RecogniserOptions {
  std::int64_t seed = 0;
  std::string split;  ///< name of the dataset's split; empty: the first one, or all clips if there is none
  RecogniserInputKind input = RecogniserInputKind::kResample;
  std::int64_t frames = 60;
  std::int64_t hidden = 128;
  std::int64_t layers = 2;  ///< Action2Motion's; MultiAct's has 4 of 256
  std::int64_t epochs = 60;
  std::int64_t batch = 32;
  double learning_rate = 2e-3;
  double weight_decay = 0.0;
  double label_smoothing = 0.0;
  bool standardise = true;     ///< train on standardised numbers, folded into the weights afterwards
  double gradient_clip = 1.0;  ///< largest norm of a step's gradient; 0: no bound
  bool anneal = true;          ///< learning rate falls to zero along half a cosine
  InitialHidden initial_hidden = InitialHidden::kZero;
  std::int64_t check_every = 5;      ///< epochs between two checks on the validation fold
  bool refit = true;                 ///< train again on all training clips once the number of epochs is chosen
  double smallest_validation = 0.1;  ///< without a validation part and persons: fraction of the training clips held out
  AugmentationOptions augmentation = {0.35, 0.1, 0.01, 0.15, 0.2, false};
  void Declare(OptionVisitor& v);
};

enum class Protocol { kReleased, kPaper };
enum class FeedbackChoice { kProtocol, kRaw, kJoints };
enum class TimeChoice { kProtocol, kNone, kReleased, kPaper };
enum class LossChoice { kProtocol, kMean, kSquaredNorm };
enum class LieExpChoice { kReleased, kExact };

struct GeneratorOptions {
  std::int64_t seed = 0;
  std::string split;       ///< as above; training clips only
  bool all_clips = false;  ///< train on every clip, as released (no held-out part)
  bool lie = true;
  Protocol protocol = Protocol::kReleased;
  std::optional<double> self_feed_probability;  ///< absent: 0.6 released, 0.4 paper
  FeedbackChoice feedback = FeedbackChoice::kProtocol;
  TimeChoice time_counter = TimeChoice::kProtocol;
  LossChoice reconstruction = LossChoice::kProtocol;
  std::optional<double> kl_weight;  ///< absent: 0.001 with Lie, 0.0001 without (released); 0.01 (paper, HumanAct12)
  LieExpChoice lie_exp = LieExpChoice::kReleased;
  bool include_last_start = false;
  RecogniserInputKind input = RecogniserInputKind::kCrop;  ///< crop: the released windows; resample: whole clips
  std::int64_t frames = 60;
  std::int64_t hidden = 128;
  std::int64_t latent = 30;
  std::int64_t iterations = 300;
  std::int64_t batch = 128;
  double learning_rate = 2e-4;
  double weight_decay = 1e-5;
  std::int64_t save_every = 50;
  AugmentationOptions augmentation;
  void Declare(OptionVisitor& v);
};

StageDeclaration TrainDeclaration();

}  // namespace mocurate
