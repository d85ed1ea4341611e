#include <map>
#include <numeric>

#include "core/base/file.h"
#include "core/pipeline/worker.h"
#include "core/store/store.h"
#include "eval/features/feature_extractor.h"
#include "eval/metrics/accuracy.h"
#include "eval/metrics/interval.h"
#include "eval/metrics/spread.h"
#include "eval/options.h"
#include "eval/protocols/draws.h"
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

/// Test accuracy of each recogniser (one per seed), their mean and summed confusion.
Expected<nlohmann::json> ScoreRecognisers(const std::vector<const StageInput*>& checkpoints, const Dataset& dataset) {
  std::vector<int> rows(dataset.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (!dataset.splits.empty() && !dataset.splits.front().test.empty()) rows = dataset.splits.front().test;
  std::vector<const Motion*> motions;
  std::vector<int> truth;
  for (const int row : rows) {
    const int label = dataset.LabelIndex(dataset.clips[row].label);
    if (label < 0) continue;
    motions.push_back(&*dataset.clips[row].motion);
    truth.push_back(label);
  }
  nlohmann::json names = nlohmann::json::array();
  for (const LabelName& label : dataset.labels) names.push_back(label.name);
  const int classes = static_cast<int>(dataset.labels.size());
  Eigen::MatrixXi confusion = Eigen::MatrixXi::Zero(classes, classes);
  std::vector<double> accuracies;
  for (const StageInput* checkpoint : checkpoints) {
    const auto recogniser = Recogniser::Load(checkpoint->path);
    if (!recogniser) return Forward(recogniser);
    const auto recognised = Recognise(**recogniser, motions, {}, 0);
    if (!recognised) return Forward(recognised);
    const Eigen::MatrixXi own = ConfusionMatrix(truth, recognised->predicted, classes);
    accuracies.push_back(Accuracy(own));
    confusion += own;
  }
  nlohmann::json matrix = nlohmann::json::array();
  for (int r = 0; r < classes; ++r) {
    matrix.push_back(std::vector<int>(classes));
    for (int c = 0; c < classes; ++c) matrix[r][c] = confusion(r, c);
  }
  return nlohmann::json{{"test_accuracy", accuracies},
                        {"mean", Summarise(accuracies, IntervalKind::kStudent).mean},
                        {"test_clips", truth.size()},
                        {"confusion", matrix},
                        {"labels", names}};
}

/// One set of motions of a repetition, as metrics see it.
struct ScoredSet {
  Features features;
  std::vector<int> labels;
  std::vector<int> predicted;
};

/// Draws, features and metrics of all repetitions.
class TableEvaluation {
 public:
  TableEvaluation(const EvaluateOptions& options, const Dataset& dataset, const Recogniser& recogniser, RealSet real)
      : options_(options), dataset_(dataset), recogniser_(recogniser), real_(std::move(real)) {}

  Expected<nlohmann::json> Run(const std::map<std::string, AnswerRequests>& generators) {
    nlohmann::json rows = {{"Real", nlohmann::json::object()}};
    for (int repetition = 0; repetition < options_.repetitions; ++repetition) {
      if (StopRequested()) return Fail(ErrorCode::kInterrupted, "evaluation stopped on request", "evaluate", "run again");
      const std::vector<int> drawn = DrawReal(real_, static_cast<int>(options_.motions), seed(), repetition, "reference");
      const auto reference = ScoreReal(drawn, repetition, 0);
      if (!reference) return Forward(reference);
      const auto reference_statistics = StatisticsOf(reference->features);
      if (!reference_statistics) return Forward(reference_statistics);
      const auto again = ScoreReal(DrawReal(real_, static_cast<int>(options_.motions), seed(), repetition, "real"), repetition, 1);
      if (!again) return Forward(again);
      if (Status added = AddMetrics(*again, *reference_statistics, repetition, rows["Real"]); !added) return Forward(added);
      const auto requests = DrawRequests(dataset_, real_, drawn, options_, recogniser_.input_frames(), repetition);
      for (const auto& [name, answer] : generators) {
        const auto scored = ScoreGenerated(answer, requests, repetition);
        if (!scored) return Forward(scored);
        if (Status added = AddMetrics(*scored, *reference_statistics, repetition, rows[name]); !added) return Forward(added);
      }
      ReportProgress((repetition + 1.0) / static_cast<double>(options_.repetitions),
                     "repetition " + std::to_string(repetition + 1));
    }
    return rows;
  }

 private:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(options_.seed); }

  RecogniserHidden Hidden(int repetition, int set) const {
    RecogniserHidden hidden;
    if (options_.random_hidden) hidden.kind = InitialHidden::kNormal;
    hidden.seed = seed() * 1000003 + static_cast<std::uint64_t>(repetition) * 16 + static_cast<std::uint64_t>(set);
    return hidden;
  }

  Expected<ScoredSet> ScoreReal(const std::vector<int>& drawn, int repetition, int set) {
    ScoredSet scored;
    for (const int position : drawn) scored.labels.push_back(real_.labels[position]);
    const bool fixed = recogniser_.input_kind() == RecogniserInputKind::kResample && !options_.random_hidden;
    if (!fixed) {
      std::vector<const Motion*> motions;
      for (const int position : drawn) motions.push_back(&*dataset_.clips[real_.rows[position]].motion);
      auto recognised = Recognise(recogniser_, motions, Hidden(repetition, set), Hidden(repetition, set).seed);
      if (!recognised) return Forward(recognised);
      scored.features = std::move(recognised->features);
      scored.predicted = std::move(recognised->predicted);
      return scored;
    }
    // Nothing is drawn per motion: each clip has one feature vector, computed once.
    if (once_.predicted.empty()) {
      std::vector<const Motion*> motions;
      for (const int row : real_.rows) motions.push_back(&*dataset_.clips[row].motion);
      auto recognised = Recognise(recogniser_, motions, {}, 0);
      if (!recognised) return Forward(recognised);
      once_ = std::move(*recognised);
    }
    scored.features.resize(static_cast<Eigen::Index>(drawn.size()), once_.features.cols());
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      scored.features.row(static_cast<Eigen::Index>(i)) = once_.features.row(drawn[i]);
      scored.predicted.push_back(once_.predicted[drawn[i]]);
    }
    return scored;
  }

  Expected<ScoredSet> ScoreGenerated(const AnswerRequests& answer, const std::vector<MotionRequest>& requests, int repetition) {
    const auto motions = answer(requests);
    if (!motions) return Forward(motions);
    if (motions->size() != requests.size()) {
      return Fail(ErrorCode::kInconsistent,
                  std::to_string(motions->size()) + " motions answer " + std::to_string(requests.size()) + " requests", "generator");
    }
    std::vector<const Motion*> pointers;
    for (const Motion& motion : *motions) pointers.push_back(&motion);
    auto recognised = Recognise(recogniser_, pointers, Hidden(repetition, 2), Hidden(repetition, 2).seed);
    if (!recognised) return Forward(recognised);
    ScoredSet scored;
    scored.features = std::move(recognised->features);
    scored.predicted = std::move(recognised->predicted);
    for (const MotionRequest& request : requests) scored.labels.push_back(request.label);
    return scored;
  }

  Status AddMetrics(const ScoredSet& set, const FeatureStatistics& reference, int repetition, nlohmann::json& row) {
    const int classes = static_cast<int>(dataset_.labels.size());
    const auto statistics = StatisticsOf(set.features);
    if (!statistics) return Forward(statistics);
    const auto distance = FrechetDistance(*statistics, reference);
    if (!distance) return Forward(distance);
    Random random(seed(), "pairs", std::to_string(repetition));
    const IndexPairs any = DrawDiversityPairs(static_cast<int>(set.labels.size()), static_cast<int>(options_.diversity_pairs), random);
    const auto same = DrawMultimodalityPairs(set.labels, classes, static_cast<int>(options_.multimodality_quota), random);
    if (!same) return Forward(same);
    row["fid"].push_back(*distance);
    row["accuracy"].push_back(Accuracy(ConfusionMatrix(set.labels, set.predicted, classes)));
    row["diversity"].push_back(MeanDistance(set.features, any));
    row["multimodality"].push_back(MeanDistance(set.features, *same));
    return {};
  }

  const EvaluateOptions& options_;
  const Dataset& dataset_;
  const Recogniser& recogniser_;
  RealSet real_;
  Recognised once_;
};

std::vector<std::string> NotesOf(const EvaluateOptions& options, const Recogniser& recogniser) {
  const char* real[] = {"all clips", "training clips", "test clips"};
  return {"Real motions: " + std::string(real[static_cast<int>(options.real)]) + ". Generated labels: " +
              (options.labels == LabelDraw::kUniform ? "uniform" : "as frequent as in the real set") + ". " +
              std::to_string(options.repetitions) + " repetitions of " + std::to_string(options.motions) + " motions.",
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
  nlohmann::json result;
  for (const char* kind : {"recogniser", "baseline_recogniser", "crop_recogniser"}) {
    const auto checkpoints = InputsOf(request, kind);
    if (checkpoints.empty()) continue;
    const bool baseline = std::string(kind) == "baseline_recogniser";
    const auto sets = InputsOf(request, baseline ? "baseline_dataset" : "dataset");
    if (sets.empty()) continue;
    const auto set = ReadDataset(sets.front()->path);
    if (!set) return Forward(set);
    const auto scored = ScoreRecognisers(checkpoints, *set);
    if (!scored) return Forward(scored);
    result[kind] = *scored;
  }

  const auto recogniser = Recogniser::Load(recognisers.front()->path);
  if (!recogniser) return Forward(recogniser);
  std::map<std::string, AnswerRequests> generators;
  for (const StageInput* input : InputsOf(request, "generator")) {
    auto answer = open_generator(input->path);
    if (!answer) return Forward(answer);
    generators[input->name] = std::move(*answer);
  }
  auto real = ChooseReal(*dataset, options->real);
  if (!real) return Forward(real);
  auto rows = TableEvaluation(*options, *dataset, **recogniser, std::move(*real)).Run(generators);
  if (!rows) return Forward(rows);
  result["rows"] = std::move(*rows);
  result["notes"] = NotesOf(*options, **recogniser);
  StageOutcome outcome;
  for (const auto& [kind, scored] : result.items()) {
    if (scored.is_object() && scored.contains("mean")) outcome.summary[kind] = scored["mean"];
  }
  if (Status written = WriteFile(request.output, result.dump(1)); !written) return Forward(written);
  return outcome;
}

}  // namespace

StageFunction MakeEvaluateStage(OpenGenerator open_generator) {
  return [open_generator = std::move(open_generator)](const StageRequest& request) { return Evaluate(open_generator, request); };
}

}  // namespace mocurate
