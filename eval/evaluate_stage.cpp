#include <map>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/store/store.h"
#include "eval/options.h"
#include "eval/protocols/draws.h"
#include "eval/protocols/recogniser_scores.h"
#include "eval/protocols/table_evaluation.h"
#include "eval/stages.h"

namespace mocurate {
namespace {

std::vector<const StageInput*> InputsOf(const StageRequest& request, const std::string& role) {
  std::vector<const StageInput*> inputs;
  for (const StageInput& input : request.inputs) {
    if (input.role == role) inputs.push_back(&input);
  }
  return inputs;
}

/// One figure set per kind of recogniser that the request holds, by its role.
Expected<nlohmann::json> ScoreEveryKind(const StageRequest& request, const std::string& split) {
  nlohmann::json scores = nlohmann::json::object();
  for (const std::string kind : {"recogniser", "baseline_recogniser", "crop_recogniser"}) {
    const auto inputs = InputsOf(request, kind);
    const auto sets = InputsOf(request, kind == "baseline_recogniser" ? "baseline_dataset" : "dataset");
    if (inputs.empty() || sets.empty()) continue;
    const auto dataset = ReadDataset(sets.front()->path);
    if (!dataset) return Forward(dataset);
    std::vector<std::filesystem::path> checkpoints;
    for (const StageInput* input : inputs) checkpoints.push_back(input->path);
    auto scored = ScoreRecognisers(checkpoints, *dataset, split);
    if (!scored) return Forward(scored);
    scores[kind] = std::move(*scored);
  }
  return scores;
}

Expected<std::map<std::string, AnswerRequests>> OpenGenerators(const OpenGenerator& open, const StageRequest& request) {
  std::map<std::string, AnswerRequests> generators;
  for (const StageInput* input : InputsOf(request, "generator")) {
    auto answer = open(input->path);
    if (!answer) return Forward(answer);
    generators[input->name] = std::move(*answer);
  }
  return generators;
}

std::vector<std::string> NotesOf(const EvaluateOptions& options, const Recogniser& recogniser) {
  const char* real[] = {"all clips", "training clips", "test clips"};
  return {
      "Real motions: " + std::string(real[static_cast<int>(options.real)]) + ". Generated labels: " +
          (options.labels == LabelDraw::kUniform ? "uniform" : "as frequent as in the real set") + ". " +
          Counted(options.repetitions, "repetition") + " of " + Counted(options.motions, "motion") + ".",
      std::string("The recogniser sees ") +
          (recogniser.input_kind() == RecogniserInputKind::kResample ? "whole clips resampled to " : "windows of ") +
          std::to_string(recogniser.input_frames()) + " frames, initial hidden state " +
          (options.random_hidden ? "random" : "zero") + "."};
}

Expected<StageOutcome> Evaluate(const OpenGenerator& open_generator, const StageRequest& request) {
  const auto options = OptionsFromJson<EvaluateOptions>(request.options, "evaluate");
  if (!options) return Forward(options);
  const auto datasets = InputsOf(request, "dataset");
  const auto recognisers = InputsOf(request, "recogniser");
  if (datasets.empty() || recognisers.empty()) {
    return Fail(ErrorCode::kInconsistent, "evaluation needs a dataset and a recogniser", "evaluate");
  }
  const auto dataset = ReadDataset(datasets.front()->path);
  if (!dataset) return Forward(dataset);
  auto result = ScoreEveryKind(request, options->split);
  if (!result) return Forward(result);
  StageOutcome outcome;
  for (const auto& [kind, scored] : result->items()) {
    if (scored.contains("mean")) outcome.summary[kind] = scored["mean"];
  }

  const auto recogniser = Recogniser::Load(recognisers.front()->path);
  if (!recogniser) return Forward(recogniser);
  const auto generators = OpenGenerators(open_generator, request);
  if (!generators) return Forward(generators);
  const auto real = ChooseReal(*dataset, options->real, options->split);
  if (!real) return Forward(real);
  auto rows = EvaluateTable(*options, *dataset, **recogniser, *real, *generators);
  if (!rows) return Forward(rows);
  (*result)["rows"] = std::move(*rows);
  (*result)["notes"] = NotesOf(*options, **recogniser);
  if (Status written = WriteFile(request.output, result->dump(1)); !written) return Forward(written);
  return outcome;
}

}  // namespace

StageFunction MakeEvaluateStage(OpenGenerator open_generator) {
  return [open_generator = std::move(open_generator)](const StageRequest& request) {
    return Evaluate(open_generator, request);
  };
}

}  // namespace mocurate
