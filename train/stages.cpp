#include "train/stages.h"

#include <optional>
#include <string>

#include "core/pipeline/worker.h"
#include "core/store/store.h"
#include "train/options.h"
#include "train/trainer/training_control.h"

namespace mocurate {
namespace {

Expected<const StageInput*> DatasetOf(const StageRequest& request) {
  for (const StageInput& input : request.inputs) {
    if (input.role == "dataset") return &input;
  }
  return Fail(ErrorCode::kInternal, "the stage got no input of role 'dataset'", request.stage + " " + request.item);
}

TrainingControl ControlOf(const StageRequest& request, const StageInput& dataset) {
  TrainingControl control;
  control.scratch = request.scratch;
  control.dataset_sha256 = dataset.sha256;
  control.stop = [] { return StopRequested(); };
  control.progress = [](double fraction, const std::string& text) { ReportProgress(fraction, text); };
  return control;
}

// N of "recogniser/N"; items without a number keep the seed of the options.
std::optional<std::int64_t> SeedOfItem(const std::string& item) {
  const std::size_t slash = item.rfind('/');
  if (slash == std::string::npos || slash + 1 == item.size() || item.size() - slash > 10) return std::nullopt;
  std::int64_t seed = 0;
  for (const char digit : item.substr(slash + 1)) {
    if (digit < '0' || digit > '9') return std::nullopt;
    seed = 10 * seed + (digit - '0');
  }
  return seed;
}

double LastOf(const Checkpoint& checkpoint, const std::string& column) {
  const auto found = checkpoint.history.find(column);
  return found == checkpoint.history.end() || found->second.empty() ? 0.0 : found->second.back();
}

}  // namespace

Expected<StageOutcome> TrainRecogniserStage(const StageRequest& request) {
  Expected<RecogniserOptions> options = OptionsFromJson<RecogniserOptions>(request.options);
  if (!options) return Forward(options);
  if (const std::optional<std::int64_t> seed = SeedOfItem(request.item)) options->seed = *seed;
  const Expected<const StageInput*> input = DatasetOf(request);
  if (!input) return Forward(input);
  const Expected<Dataset> dataset = ReadDataset((*input)->path);
  if (!dataset) return Forward(dataset);
  const Expected<Checkpoint> checkpoint = TrainRecogniser(*dataset, *options, ControlOf(request, **input));
  if (!checkpoint) return Forward(checkpoint);
  if (Status written = WriteCheckpoint(*checkpoint, request.output); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"kind", checkpoint->kind},
                     {"seed", options->seed},
                     {"classes", checkpoint->labels.size()},
                     {"split", checkpoint->facts.at("split")},
                     {"validation_rule", checkpoint->facts.at("validation_rule")},
                     {"validation_accuracy", checkpoint->facts.at("best_accuracy")},
                     {"chosen_epoch", checkpoint->facts.at("best_epoch")},
                     {"epochs", checkpoint->step},
                     {"refit", options->refit},
                     {"train_accuracy", LastOf(*checkpoint, "train_accuracy")},
                     {"history", checkpoint->history}};
  return outcome;
}

Expected<StageOutcome> TrainGeneratorStage(const StageRequest& request) {
  const Expected<GeneratorOptions> options = OptionsFromJson<GeneratorOptions>(request.options);
  if (!options) return Forward(options);
  const Expected<const StageInput*> input = DatasetOf(request);
  if (!input) return Forward(input);
  const Expected<Dataset> dataset = ReadDataset((*input)->path);
  if (!dataset) return Forward(dataset);
  const Expected<Checkpoint> checkpoint = TrainGenerator(*dataset, *options, ControlOf(request, **input));
  if (!checkpoint) return Forward(checkpoint);
  if (Status written = WriteCheckpoint(*checkpoint, request.output); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"kind", checkpoint->kind},
                     {"lie", options->lie},
                     {"iterations", checkpoint->step},
                     {"batch", checkpoint->facts.at("batch")},
                     {"clips", checkpoint->facts.at("clips")},
                     {"loss", LastOf(*checkpoint, "loss")},
                     {"reconstruction", LastOf(*checkpoint, "reconstruction")},
                     {"kl", LastOf(*checkpoint, "kl")},
                     {"history", checkpoint->history}};
  return outcome;
}

}  // namespace mocurate
