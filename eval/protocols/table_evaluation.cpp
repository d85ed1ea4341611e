#include "eval/protocols/table_evaluation.h"

#include <nlohmann/json.hpp>

#include "core/pipeline/worker.h"
#include "eval/features/feature_extractor.h"
#include "eval/metrics/accuracy.h"
#include "eval/metrics/spread.h"

namespace mocurate {
namespace {

/// One set of motions of a repetition, as metrics see it.
struct ScoredSet {
  Features features;
  std::vector<int> labels;
  std::vector<int> predicted;
};

/// Which set of a repetition a hidden state or a crop is drawn for.
enum class SetOfRepetition { kReference = 0, kReal = 1, kGenerated = 2 };

/// Draws, features and metrics of all repetitions.
class TableEvaluation {
 public:
  TableEvaluation(const EvaluateOptions& options, const Dataset& dataset, const Recogniser& recogniser,
                  const RealSet& real)
      : options_(options), dataset_(dataset), recogniser_(recogniser), real_(real) {}

  Expected<nlohmann::json> Run(const std::map<std::string, AnswerRequests>& generators) {
    rows_ = {{"Real", nlohmann::json::object()}};
    for (int repetition = 0; repetition < options_.repetitions; ++repetition) {
      if (StopRequested()) {
        return Fail(ErrorCode::kInterrupted, "evaluation stopped on request", "evaluate", "run again");
      }
      if (Status done = Repeat(generators, repetition); !done) return Forward(done);
      ReportProgress((repetition + 1.0) / static_cast<double>(options_.repetitions),
                     "repetition " + std::to_string(repetition + 1));
    }
    return rows_;
  }

 private:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(options_.seed); }

  Status Repeat(const std::map<std::string, AnswerRequests>& generators, int repetition) {
    const int count = static_cast<int>(options_.motions);
    const std::vector<int> drawn = DrawReal(real_, count, seed(), repetition, "reference");
    const auto reference_set = ScoreReal(drawn, repetition, SetOfRepetition::kReference);
    if (!reference_set) return Forward(reference_set);
    const auto reference = StatisticsOf(reference_set->features);
    if (!reference) return Forward(reference);
    const auto again =
        ScoreReal(DrawReal(real_, count, seed(), repetition, "real"), repetition, SetOfRepetition::kReal);
    if (!again) return Forward(again);
    if (Status added = AddMetrics(*again, *reference, repetition, rows_["Real"]); !added) return added;
    const auto requests = DrawRequests(dataset_, real_, drawn, options_, recogniser_.input_frames(), repetition);
    for (const auto& [name, answer] : generators) {
      const auto scored = ScoreGenerated(answer, requests, repetition);
      if (!scored) return Forward(scored);
      if (Status added = AddMetrics(*scored, *reference, repetition, rows_[name]); !added) return added;
    }
    return {};
  }

  RecogniserHidden Hidden(int repetition, SetOfRepetition set) const {
    RecogniserHidden hidden;
    if (options_.random_hidden) hidden.kind = InitialHidden::kNormal;
    hidden.seed = seed() * 1000003 + static_cast<std::uint64_t>(repetition) * 16 + static_cast<std::uint64_t>(set);
    return hidden;
  }

  Expected<ScoredSet> Score(const std::vector<const Motion*>& motions, std::vector<int> labels, int repetition,
                            SetOfRepetition set) const {
    const RecogniserHidden hidden = Hidden(repetition, set);
    auto recognised = Recognise(recogniser_, motions, hidden, hidden.seed);
    if (!recognised) return Forward(recognised);
    return ScoredSet{std::move(recognised->features), std::move(labels), std::move(recognised->predicted)};
  }

  Expected<ScoredSet> ScoreReal(const std::vector<int>& drawn, int repetition, SetOfRepetition set) {
    std::vector<int> labels;
    for (const int position : drawn) labels.push_back(real_.labels[position]);
    const bool fixed = recogniser_.input_kind() == RecogniserInputKind::kResample && !options_.random_hidden;
    if (fixed) return ScoreFixed(drawn, std::move(labels));
    std::vector<const Motion*> motions;
    for (const int position : drawn) motions.push_back(&*dataset_.clips[real_.rows[position]].motion);
    return Score(motions, std::move(labels), repetition, set);
  }

  /// Nothing is drawn per motion: each clip has one feature vector, computed once.
  Expected<ScoredSet> ScoreFixed(const std::vector<int>& drawn, std::vector<int> labels) {
    if (once_.predicted.empty()) {
      std::vector<const Motion*> motions;
      for (const int row : real_.rows) motions.push_back(&*dataset_.clips[row].motion);
      auto recognised = Recognise(recogniser_, motions, {}, 0);
      if (!recognised) return Forward(recognised);
      once_ = std::move(*recognised);
    }
    ScoredSet scored;
    scored.labels = std::move(labels);
    scored.features.resize(static_cast<Eigen::Index>(drawn.size()), once_.features.cols());
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      scored.features.row(static_cast<Eigen::Index>(i)) = once_.features.row(drawn[i]);
      scored.predicted.push_back(once_.predicted[drawn[i]]);
    }
    return scored;
  }

  Expected<ScoredSet> ScoreGenerated(const AnswerRequests& answer, const std::vector<MotionRequest>& requests,
                                     int repetition) const {
    const auto motions = answer(requests);
    if (!motions) return Forward(motions);
    if (motions->size() != requests.size()) {
      return Fail(ErrorCode::kInconsistent,
                  std::to_string(motions->size()) + " motions answer " + std::to_string(requests.size()) + " requests",
                  "generator");
    }
    std::vector<const Motion*> pointers;
    for (const Motion& motion : *motions) pointers.push_back(&motion);
    std::vector<int> labels;
    for (const MotionRequest& request : requests) labels.push_back(request.label);
    return Score(pointers, std::move(labels), repetition, SetOfRepetition::kGenerated);
  }

  Status AddMetrics(const ScoredSet& set, const FeatureStatistics& reference, int repetition, nlohmann::json& row) {
    std::vector<std::string> names;
    for (const auto& label : dataset_.labels) names.push_back(label.name);
    const auto statistics = StatisticsOf(set.features);
    if (!statistics) return Forward(statistics);
    const auto distance = FrechetDistance(*statistics, reference);
    if (!distance) return Forward(distance);
    Random random(seed(), "pairs", std::to_string(repetition));
    const IndexPairs any =
        DrawDiversityPairs(static_cast<int>(set.labels.size()), static_cast<int>(options_.diversity_pairs), random);
    const auto same = DrawMultimodalityPairs(set.labels, names, static_cast<int>(options_.multimodality_quota), random);
    if (!same) return Forward(same);
    row["fid"].push_back(*distance);
    row["accuracy"].push_back(Accuracy(ConfusionMatrix(set.labels, set.predicted, static_cast<int>(names.size()))));
    row["diversity"].push_back(MeanDistance(set.features, any));
    row["multimodality"].push_back(MeanDistance(set.features, *same));
    return {};
  }

  const EvaluateOptions& options_;
  const Dataset& dataset_;
  const Recogniser& recogniser_;
  const RealSet& real_;
  Recognised once_;
  nlohmann::json rows_;
};

}  // namespace

Expected<nlohmann::json> EvaluateTable(const EvaluateOptions& options, const Dataset& dataset,
                                       const Recogniser& recogniser, const RealSet& real,
                                       const std::map<std::string, AnswerRequests>& generators) {
  return TableEvaluation(options, dataset, recogniser, real).Run(generators);
}

}  // namespace mocurate
