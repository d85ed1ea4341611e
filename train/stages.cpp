#include "train/stages.h"

#include <string>

#include "core/pipeline/worker.h"
#include "core/store/store.h"
#include "train/items.h"
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

double LastOf(const Checkpoint& checkpoint, const std::string& column) {
  const auto found = checkpoint.history.find(column);
  return found == checkpoint.history.end() || found->second.empty() ? 0.0 : found->second.back();
}

Expected<Checkpoint> Train(const Dataset& dataset, const NetworkOptions& options, const TrainingControl& control) {
  return options.network == NetworkKind::kRecogniser ? TrainRecogniser(dataset, options.recogniser, control)
                                                     : TrainGenerator(dataset, options.generator, control);
}

nlohmann::json RecogniserSummary(const Checkpoint& checkpoint, const RecogniserOptions& options) {
  return {{"kind", checkpoint.kind},
          {"seed", options.seed},
          {"classes", checkpoint.labels.size()},
          {"split", checkpoint.facts.at("split")},
          {"validation_rule", checkpoint.facts.at("validation_rule")},
          {"validation_accuracy", checkpoint.facts.at("best_accuracy")},
          {"chosen_epoch", checkpoint.facts.at("best_epoch")},
          {"epochs", checkpoint.step},
          {"refit", options.refit},
          {"train_accuracy", LastOf(checkpoint, "train_accuracy")},
          {"history", checkpoint.history}};
}

nlohmann::json GeneratorSummary(const Checkpoint& checkpoint, const GeneratorOptions& options) {
  return {{"kind", checkpoint.kind},
          {"lie", options.lie},
          {"iterations", checkpoint.step},
          {"batch", checkpoint.facts.at("batch")},
          {"clips", checkpoint.facts.at("clips")},
          {"loss", LastOf(checkpoint, "loss")},
          {"reconstruction", LastOf(checkpoint, "reconstruction")},
          {"kl", LastOf(checkpoint, "kl")},
          {"history", checkpoint.history}};
}

}  // namespace

Expected<StageOutcome> TrainStage(const StageRequest& request) {
  const Expected<NetworkOptions> options = OptionsFromJson<NetworkOptions>(request.options);
  if (!options) return Forward(options);
  const Expected<const StageInput*> input = DatasetOf(request);
  if (!input) return Forward(input);
  const Expected<Dataset> dataset = ReadDataset((*input)->path);
  if (!dataset) return Forward(dataset);
  const Expected<Checkpoint> checkpoint = Train(*dataset, *options, ControlOf(request, **input));
  if (!checkpoint) return Forward(checkpoint);
  if (Status written = WriteCheckpoint(*checkpoint, request.output); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = options->network == NetworkKind::kRecogniser ? RecogniserSummary(*checkpoint, options->recogniser)
                                                                 : GeneratorSummary(*checkpoint, options->generator);
  return outcome;
}

}  // namespace mocurate
