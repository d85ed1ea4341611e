#include <algorithm>

#include "core/base/random.h"
#include "train/data/training_clips.h"
#include "train/trainer/generator_rules.h"
#include "train/trainer/training_control.h"

namespace mocurate {
namespace {

Checkpoint StartState(const Dataset& dataset, const GeneratorOptions& options, const Action2MotionConfig& config,
                      const TrainingControl& control) {
  Checkpoint state;
  state.kind = kAction2MotionKind;
  state.options = OptionsToJson(options);
  state.skeleton = dataset.skeleton;
  state.dataset_sha256 = control.dataset_sha256;
  for (const std::string& label : dataset.labels) state.labels.push_back(label);
  state.parameters = Action2MotionParameters(config);
  Random random(static_cast<std::uint64_t>(options.seed), "generator.initial");
  Initialise(state.parameters, random);
  return state;
}

// Rows of iteration `i`: passes in shuffled order, the last partial batch dropped (B.6).
std::vector<int> RowsOf(const GeneratorOptions& options, int count, int batch, std::int64_t i) {
  const std::int64_t per_pass = count / batch;
  const std::vector<int> order = ShuffledOrder(
      count, Random(static_cast<std::uint64_t>(options.seed), "generator.order", std::to_string(i / per_pass)));
  const auto first = order.begin() + static_cast<std::ptrdiff_t>((i % per_pass) * batch);
  return std::vector<int>(first, first + batch);
}

void Record(const Action2MotionLoss& loss, int frames, bool self_feed, Checkpoint& state) {
  state.history["loss"].push_back(loss.total / frames);
  state.history["reconstruction"].push_back(loss.reconstruction / frames);
  state.history["kl"].push_back(loss.kl / frames);
  state.history["self_feed"].push_back(self_feed ? 1.0 : 0.0);
  ++state.step;
}

}  // namespace

Expected<Checkpoint> TrainGenerator(const Dataset& dataset, const GeneratorOptions& options,
                                    const TrainingControl& control) {
  const Expected<TrainingClips> clips = SelectTrainingClips(dataset, options.split, options.all_clips, false,
                                                            static_cast<std::uint64_t>(options.seed), 0.1);
  if (!clips) return Forward(clips);
  const Action2MotionConfig config = ConfigOf(options, *dataset.skeleton, static_cast<int>(dataset.labels.size()));
  const int count = static_cast<int>(clips->train.size());
  const int batch_size = std::min(count, static_cast<int>(options.batch));
  const double self_feed = SelfFeedProbability(options);
  std::optional<Checkpoint> resumed = ResumeFrom(control, kAction2MotionKind, OptionsToJson(options));
  Checkpoint state = resumed ? std::move(*resumed) : StartState(dataset, options, config, control);
  state.facts = {{"split", clips->split},
                 {"clips", count},
                 {"batch", batch_size},
                 {"rate", clips->train.front().clip->motion->rate.Text()},
                 {"parameters", CountValues(state.parameters)}};
  AdamOptions adam;
  adam.learning_rate = options.learning_rate;
  adam.weight_decay = options.weight_decay;
  while (state.step < options.iterations) {
    if (control.stop()) {
      if (Status saved = SaveState(control, state); !saved) return Forward(saved);
      return Fail(ErrorCode::kInterrupted,
                  "training of the generator was stopped after " + std::to_string(state.step) + " iterations", "train",
                  "run again to go on");
    }
    const Action2MotionBatch batch = MakeGeneratorBatch(options, config, self_feed, clips->train,
                                                        RowsOf(options, count, batch_size, state.step), state.step);
    const Action2MotionLoss loss = Action2MotionStep(config, batch, state.parameters);
    state.adam.Step(adam, state.parameters);
    Record(loss, batch.frames, batch.self_feed, state);
    control.progress(static_cast<double>(state.step) / static_cast<double>(options.iterations),
                     "generator: step " + std::to_string(state.step) + " of " + std::to_string(options.iterations));
    if (state.step % options.save_every == 0) {
      if (Status saved = SaveState(control, state); !saved) return Forward(saved);
    }
  }
  state.finished = true;
  return state;
}

}  // namespace mocurate
