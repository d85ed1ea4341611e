#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "train/data/standardisation.h"
#include "train/data/training_clips.h"
#include "train/recognisers/gru_recogniser.h"
#include "train/trainer/training_control.h"

namespace mocurate {
namespace {

struct Score {
  double accuracy = 0.0;
  double loss = 0.0;
};

void Count(const std::vector<float>& logits, const std::vector<int>& label, int classes, Score& sum) {
  for (std::size_t b = 0; b < label.size(); ++b) {
    const float* row = logits.data() + b * classes;
    const float top = *std::max_element(row, row + classes);
    double total = 0.0;
    for (int c = 0; c < classes; ++c) total += std::exp(static_cast<double>(row[c]) - top);
    sum.loss += std::log(total) + top - row[label[b]];
    sum.accuracy += row[label[b]] == top ? 1.0 : 0.0;
  }
}

class RecogniserTraining {
 public:
  RecogniserTraining(const Dataset& dataset, const RecogniserOptions& options, const TrainingControl& control)
      : dataset_(dataset), options_(options), control_(control) {}

  Expected<Checkpoint> Run();

 private:
  void Start();
  void StartPhase(int phase);
  void Epoch();
  void Check();
  Score Validate() const;
  double LearningRate(std::int64_t epoch, double part) const;
  std::int64_t PhaseEpochs() const { return phase_ == 0 ? options_.epochs : best_epoch_; }
  bool Ended() const { return phase_ == 2; }
  void Keep();
  void Restore();

  const Dataset& dataset_;
  const RecogniserOptions& options_;
  const TrainingControl& control_;
  GruRecogniserConfig config_;
  TrainingClips clips_;
  Standardisation standard_;
  Checkpoint state_;
  int phase_ = 0;           ///< 0: fold held out, 1: refit on all, 2: done
  std::int64_t epoch_ = 0;  ///< done in this phase
  std::int64_t best_epoch_ = 0;
  Score best_;
};

void RecogniserTraining::StartPhase(int phase) {
  phase_ = phase;
  epoch_ = 0;
  state_.parameters = GruRecogniserParameters(config_);
  Random random(static_cast<std::uint64_t>(options_.seed), "recogniser.initial");
  Initialise(state_.parameters, random);
  state_.adam = Adam();
  if (phase == 1) {
    clips_.train.insert(clips_.train.end(), clips_.validation.begin(), clips_.validation.end());
    std::sort(clips_.train.begin(), clips_.train.end(),
              [](const TrainingClip& a, const TrainingClip& b) { return a.clip < b.clip; });
  }
  if (options_.standardise) standard_ = Standardisation::Of(options_, clips_.train);
}

double RecogniserTraining::LearningRate(std::int64_t epoch, double part) const {
  if (!options_.anneal) return options_.learning_rate;
  const double at = (static_cast<double>(epoch) + part) / static_cast<double>(PhaseEpochs());
  return options_.learning_rate * 0.5 * (1.0 + std::cos(kPi * at));
}

void RecogniserTraining::Epoch() {
  const int count = static_cast<int>(clips_.train.size());
  const std::int64_t pass = 1000000 * phase_ + epoch_;
  const std::vector<int> order =
      ShuffledOrder(count, Random(static_cast<std::uint64_t>(options_.seed), "recogniser.order", std::to_string(pass)));
  Score sum;
  double loss = 0.0;
  for (int begin = 0; begin < count; begin += static_cast<int>(options_.batch)) {
    const int end = std::min(count, begin + static_cast<int>(options_.batch));
    const std::vector<int> rows(order.begin() + begin, order.begin() + end);
    GruRecogniserBatch batch = MakeRecogniserBatch(options_, clips_.train, rows, pass, true);
    if (options_.standardise) standard_.Apply(batch.motion);
    if (options_.initial_hidden == InitialHidden::kNormal) {
      Random random(static_cast<std::uint64_t>(options_.seed), "recogniser.hidden",
                    std::to_string(pass) + "/" + std::to_string(begin));
      batch.initial_hidden.resize(static_cast<std::size_t>(2) * batch.batch * config_.hidden);
      for (float& value : batch.initial_hidden) value = static_cast<float>(random.Normal());
    }
    std::vector<int> label;
    for (const int row : rows) label.push_back(clips_.train[static_cast<std::size_t>(row)].label);
    std::vector<float> logits;
    loss += GruRecogniserStep(config_, batch, label, options_.label_smoothing, state_.parameters, &logits) *
            static_cast<double>(rows.size());
    if (options_.gradient_clip > 0.0) ClipGradients(options_.gradient_clip, state_.parameters);
    AdamOptions adam;
    adam.learning_rate = LearningRate(epoch_, static_cast<double>(begin) / count);
    adam.weight_decay = options_.weight_decay;
    state_.adam.Step(adam, state_.parameters);
    Count(logits, label, config_.classes, sum);
  }
  ++epoch_;
  state_.history["epoch"].push_back(static_cast<double>(epoch_));
  state_.history["phase"].push_back(phase_);
  state_.history["train_loss"].push_back(loss / count);
  state_.history["train_accuracy"].push_back(sum.accuracy / count);
}

Score RecogniserTraining::Validate() const {
  Score score;
  const int count = static_cast<int>(clips_.validation.size());
  for (int begin = 0; begin < count; begin += 128) {
    std::vector<int> rows(static_cast<std::size_t>(std::min(128, count - begin)));
    std::iota(rows.begin(), rows.end(), begin);
    GruRecogniserBatch batch = MakeRecogniserBatch(options_, clips_.validation, rows, 0, false);
    if (options_.standardise) standard_.Apply(batch.motion);
    std::vector<int> label;
    for (const int row : rows) label.push_back(clips_.validation[static_cast<std::size_t>(row)].label);
    Count(RunGruRecogniser(config_, state_.parameters, batch).logits, label, config_.classes, score);
  }
  score.accuracy /= count;
  score.loss /= count;
  return score;
}

void RecogniserTraining::Check() {
  const Score score = Validate();
  state_.history["check_epoch"].push_back(static_cast<double>(epoch_));
  state_.history["validation_accuracy"].push_back(score.accuracy);
  state_.history["validation_loss"].push_back(score.loss);
  // A rate that is annealed is meant to end: what stands in the middle was still on its way.
  const bool better = options_.anneal || best_epoch_ == 0 || score.accuracy > best_.accuracy ||
                      (score.accuracy == best_.accuracy && score.loss < best_.loss);
  if (!better) return;
  best_ = score;
  best_epoch_ = epoch_;
  state_.best = state_.parameters;
}

void RecogniserTraining::Keep() {
  state_.step = static_cast<std::int64_t>(state_.history["epoch"].size());
  state_.facts = {{"input", config_.input},    {"classes", config_.classes},
                  {"hidden", config_.hidden},  {"features", config_.features},
                  {"split", clips_.split},     {"validation_rule", clips_.validation_rule},
                  {"phase", phase_},           {"epoch", epoch_},
                  {"best_epoch", best_epoch_}, {"best_accuracy", best_.accuracy},
                  {"best_loss", best_.loss},   {"rate", clips_.train.front().clip->motion->rate.Text()}};
}

void RecogniserTraining::Restore() {
  const int phase = state_.facts.at("phase").get<int>();
  best_epoch_ = state_.facts.at("best_epoch").get<std::int64_t>();
  best_.accuracy = state_.facts.at("best_accuracy").get<double>();
  best_.loss = state_.facts.at("best_loss").get<double>();
  const Checkpoint saved = state_;
  StartPhase(phase);
  state_ = saved;
  phase_ = phase;
  epoch_ = state_.facts.at("epoch").get<std::int64_t>();
}

void RecogniserTraining::Start() {
  state_.kind = kGruRecogniserKind;
  state_.options = OptionsToJson(options_);
  state_.skeleton = dataset_.skeleton;
  state_.dataset_sha256 = control_.dataset_sha256;
  for (const std::string& label : dataset_.labels) state_.labels.push_back(label);
  StartPhase(0);
}

Expected<Checkpoint> RecogniserTraining::Run() {
  Expected<TrainingClips> clips = SelectTrainingClips(
      dataset_, options_.split, false, true, static_cast<std::uint64_t>(options_.seed), options_.smallest_validation);
  if (!clips) return Forward(clips);
  clips_ = std::move(*clips);
  config_ = {3 * dataset_.skeleton->joint_count(), static_cast<int>(dataset_.labels.size()),
             static_cast<int>(options_.hidden), static_cast<int>(options_.layers)};
  if (std::optional<Checkpoint> saved = ResumeFrom(control_, kGruRecogniserKind, OptionsToJson(options_)); saved) {
    state_ = std::move(*saved);
    Restore();
  } else {
    Start();
  }
  while (!Ended()) {
    if (control_.stop()) {
      Keep();
      if (Status saved = SaveState(control_, state_); !saved) return Forward(saved);
      return Fail(ErrorCode::kInterrupted,
                  "training of the recogniser was stopped after " + std::to_string(state_.step) + " epochs", "train",
                  "run again to go on");
    }
    Epoch();
    if (phase_ == 0 && (epoch_ % options_.check_every == 0 || epoch_ == options_.epochs)) Check();
    const double share = static_cast<double>(epoch_) / static_cast<double>(PhaseEpochs());
    control_.progress(options_.refit ? 0.5 * (phase_ + share) : share,
                      "recogniser: epoch " + std::to_string(epoch_) + " of " + std::to_string(PhaseEpochs()));
    if (epoch_ >= PhaseEpochs()) {
      if (phase_ == 0 && options_.refit) {
        StartPhase(1);
      } else {
        if (phase_ == 0) state_.parameters = state_.best;
        phase_ = 2;
      }
    }
    Keep();
    if (!Ended() && state_.step % 20 == 0) {
      if (Status saved = SaveState(control_, state_); !saved) return Forward(saved);
    }
  }
  if (options_.standardise) standard_.Fold(state_.parameters);
  state_.best.clear();
  state_.finished = true;
  return state_;
}

}  // namespace

Expected<Checkpoint> TrainRecogniser(const Dataset& dataset, const RecogniserOptions& options,
                                     const TrainingControl& control) {
  return RecogniserTraining(dataset, options, control).Run();
}

}  // namespace mocurate
