#include "eval/protocols/score.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "core/base/text.h"
#include "eval/metrics/accuracy.h"
#include "eval/metrics/feature_distances.h"
#include "eval/protocols/draws.h"
#include "eval/protocols/sampled_metrics.h"

namespace mocurate {
namespace {

/// A share of memorised motions above which a row has a warning: one copy can be chance, as where two people stand.
constexpr double kMemorisedShare = 0.01;

Features Gather(const FeatureSet& set, const std::vector<int>& rows) {
  Features features(static_cast<Eigen::Index>(rows.size()), set.feature_size);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const float* row =
        set.features.data() + static_cast<std::size_t>(rows[i]) * static_cast<std::size_t>(set.feature_size);
    for (int k = 0; k < set.feature_size; ++k) features(static_cast<Eigen::Index>(i), k) = row[k];
  }
  return features;
}

ScoredRows TakeRows(const FeatureSet& set, std::vector<int> rows) {
  ScoredRows scored;
  scored.features = Gather(set, rows);
  for (const int row : rows) scored.labels.push_back(set.label[static_cast<std::size_t>(row)]);
  scored.rows = std::move(rows);
  return scored;
}

/// The rows, each clip once: copies from a draw with replacement would be each other's nearest.
std::vector<int> DistinctClips(const FeatureSet& set, const std::vector<int>& rows) {
  std::set<std::string> seen;
  std::vector<int> distinct;
  for (const int row : rows) {
    if (seen.insert(set.clip[static_cast<std::size_t>(row)]).second) distinct.push_back(row);
  }
  return distinct;
}

std::vector<int> RowsOfFirstPass(const FeatureSet& set) {
  std::vector<int> rows(static_cast<std::size_t>(set.passes() > 1 ? set.pass_end(0) : set.count()));
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

Expected<double> FidOf(const Features& a, const Features& b) {
  const auto first = StatisticsOf(a);
  if (!first) return Forward(first);
  const auto second = StatisticsOf(b);
  if (!second) return Forward(second);
  return FrechetDistance(*first, *second);
}

/// Metrics of a row, repetition by repetition.
class RowScore {
 public:
  RowScore(const ScoreOptions& options, const FeatureSet& row, const References& references)
      : options_(options), row_(row), references_(references) {}

  Expected<nlohmann::json> Run() {
    if (row_.count() == 0) return Fail(ErrorCode::kInconsistent, "the set is empty", options_.name);
    for (const FeatureSet* reference : {references_.train, references_.test}) {
      if (reference == nullptr || reference->feature_size == row_.feature_size) continue;
      return Fail(ErrorCode::kInconsistent,
                  std::to_string(row_.feature_size) + " features a motion, the reference has " +
                      std::to_string(reference->feature_size),
                  options_.name, "score both sets with one extractor");
    }
    std::set<std::string> unknown;
    equivalent_ = EquivalentOf(options_.equivalent, row_.classes, unknown);
    if (!unknown.empty()) {
      Warn("equivalent_without_class", Counted(static_cast<long long>(unknown.size()), "name") +
                                           " of `equivalent` not among the extractor's classes, e.g. '" +
                                           *unknown.begin() + "': ignored");
    }
    NoteClasses();
    const int repetitions = static_cast<int>(std::max<std::int64_t>(1, options_.draw.repetitions));
    for (int r = 0; r < repetitions; ++r) {
      if (Status done = Repeat(r); !done) return Forward(done);
    }
    return Json();
  }

 private:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(options_.seed); }
  bool real() const { return options_.real != RealRow::kNone; }
  /// A sample of the row; its persons are known where its motions are real.
  FeatureSample Sample(const std::vector<int>& rows) const { return SampleOf(row_, rows, real()); }
  bool drawn() const {
    return options_.draw.repetitions > 1 || options_.draw.motions > 0 || options_.draw.per_label > 0;
  }

  void Warn(const char* code, const std::string& message) {
    warnings_.push_back({{"code", code}, {"row", options_.name}, {"message", message}});
  }

  void NoteClasses() {
    std::vector<int> members(row_.classes.size(), 0);
    for (const int label : row_.label) {
      if (label >= 0) ++members[static_cast<std::size_t>(label)];
    }
    labelled_ = std::accumulate(members.begin(), members.end(), 0);
    std::string missing;
    for (std::size_t c = 0; c < members.size(); ++c) {
      if (members[c] > 0) continue;
      missing += (missing.empty() ? "" : ", ") + row_.classes[c];
      ++absent_;
    }
    if (labelled_ == 0) {
      Warn("no_labels", "the motions have no labels: accuracy and multimodality are null; supply " +
                            std::string(real() ? "--real-labels FILE" : "--labels FILE"));
    } else if (absent_ > 0) {
      const bool divided = options_.metrics.divisor == MultimodalityDivisor::kAll;
      Warn("class_without_motions",
           "no motion of " + missing + ": multimodality " +
               (divided ? "is still divided by all classes" : "is null; add motions of these classes"));
    }
    const int unlabelled = row_.count() - labelled_;
    if (labelled_ > 0 && unlabelled > 0) {
      Warn("motions_without_label", Counted(unlabelled, "motion") + " without a label do not count in the accuracy");
    }
  }

  /// A real set against itself: two halves of the clips of `rows`.
  std::pair<ScoredRows, ScoredRows> Halves(const std::vector<int>& rows, int repetition) const {
    std::vector<int> order = DistinctClips(row_, rows);
    const auto count = static_cast<int>(order.size());
    const std::vector<int> drawn = DrawPositions(count, count, false, seed(), repetition, "halves");
    std::transform(drawn.begin(), drawn.end(), order.begin(),
                   [of = order](int at) { return of[static_cast<std::size_t>(at)]; });
    const auto half = order.begin() + count / 2;
    return {TakeRows(row_, {order.begin(), half}), TakeRows(row_, {half, order.end()})};
  }

  Status Repeat(int repetition) {
    const ScoredRows row = RowsOfRepetition(row_, options_.draw, seed(), repetition, real() ? "real" : "generated");
    if (row.rows.empty()) {
      return Fail(ErrorCode::kInconsistent, "no motion has a label, but the protocol draws motions of each label",
                  options_.name,
                  std::string(real() ? "--real-labels" : "--labels") + " FILE: supply them with this option");
    }
    if (repetition == 0) motions_ = static_cast<int>(row.rows.size());
    AddAccuracy(row, repetition);
    if (Status spread = AddSpread(row, repetition); !spread) return spread;
    if (repetition == 0) AddQuality(row);
    const std::pair<const char*, const FeatureSet*> sides[] = {{"FID_train", references_.train},
                                                               {"FID_test", references_.test}};
    for (const auto& [name, reference_set] : sides) {
      if (reference_set == nullptr) continue;
      const bool itself = options_.real == (reference_set == references_.train ? RealRow::kTrain : RealRow::kTest);
      const bool halved = itself && !drawn();
      std::pair<ScoredRows, ScoredRows> halves;
      if (itself && (halved || repetition == 0)) halves = Halves(row.rows, repetition);
      const ScoredRows reference =
          halved ? halves.second : RowsOfRepetition(*reference_set, options_.draw, seed(), repetition, "reference");
      const Features& compared = halved ? halves.first.features : row.features;
      if (Status added = AddFid(name, compared, reference.features, repetition); !added) return added;
      if (repetition > 0) continue;
      const FeatureSample own = Sample(itself ? halves.first.rows : DistinctClips(row_, row.rows));
      const FeatureSample real = SampleOf(*reference_set, DistinctClips(*reference_set, reference.rows), true);
      // Against itself, a motion would be its own neighbour.
      const FeatureSample against = itself ? Sample(halves.second.rows) : real;
      if (reference_set == references_.train) {
        // The same for every row, also for the real motions, which may be drawn apart.
        const FeatureSample whole =
            SampleOf(*reference_set, DistinctClips(*reference_set, RowsOfFirstPass(*reference_set)), true);
        if (Status added = AddSampledMetrics(own, against, whole, itself, seed(), figures_); !added) return added;
        NoteMemorised(own);
        if (!itself) AddMovement(row.rows, *reference_set, reference.rows);
      } else if (const auto added = AddFidInterval(name, own, against, seed(), figures_); !added) {
        return Forward(added);
      }
    }
    return {};
  }

  void NoteMemorised(const FeatureSample& own) {
    const Figure& figure = figures_["memorised"];
    if (!real() && figure.more.value("own_nearest", 1.0) < kMemorised) {
      Warn("equal_motions",
           "the motions are nearly equal to each other, as the extractor sees them: intervals and p "
           "count each as a motion of its own");
    }
    if (real() || figure.values.empty() || figure.values.front() <= kMemorisedShare) return;
    const auto copies = static_cast<long long>(std::llround(figure.values.front() * own.count()));
    Warn("memorised", Counted(copies, "motion") + " of " + std::to_string(own.count()) +
                          (copies == 1 ? " is a copy" : " are copies") +
                          " of real motions, as the extractor sees them: FID does not show what the network adds; "
                          "score it against motions that it was not trained on");
  }

  void AddMovement(const std::vector<int>& rows, const FeatureSet& real, const std::vector<int>& real_rows) {
    const auto ratio = MovementOfReal(row_, rows, real, real_rows);
    if (!ratio) return;
    figures_["movement_of_real"].values = {*ratio};
    if (*ratio >= options_.metrics.least_movement) return;
    Warn("hardly_moves", "the motions move " + RoundedText(*ratio, 2) +
                             " times as much as real ones of their label: FID and accuracy may be good all the same");
  }

  void AddAccuracy(const ScoredRows& row, int repetition) {
    if (labelled_ == 0) return;
    const int classes = row_.class_count();
    std::vector<float> logits;
    std::vector<int> predicted;
    for (const int at : row.rows) {
      const float* of_row = row_.logits.data() + static_cast<std::size_t>(at) * static_cast<std::size_t>(classes);
      logits.insert(logits.end(), of_row, of_row + classes);
      predicted.push_back(LargestLogit(of_row, classes));
    }
    figures_["accuracy"].values.push_back(AcceptedShare(row.labels, logits.data(), classes, 1));
    figures_["accuracy_top5"].values.push_back(AcceptedShare(row.labels, logits.data(), classes, 5));
    if (!equivalent_.empty()) {
      figures_["accuracy_equivalent"].values.push_back(
          AcceptedShare(row.labels, logits.data(), classes, 1, equivalent_));
      figures_["accuracy_top5_equivalent"].values.push_back(
          AcceptedShare(row.labels, logits.data(), classes, 5, equivalent_));
    }
    const Eigen::MatrixXi confusion = ConfusionMatrix(row.labels, predicted, classes);
    confusion_ = confusion_.size() == 0 ? confusion : Eigen::MatrixXi(confusion_ + confusion);
    if (repetition > 0) return;
    std::vector<int> labelled;
    std::vector<double> right;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      if (row.labels[i] < 0) continue;
      labelled.push_back(row.rows[i]);
      right.push_back(predicted[i] == row.labels[i] ? 1.0 : 0.0);
    }
    if (labelled.empty()) return;
    const Eigen::Map<const Eigen::VectorXd> values(right.data(), static_cast<Eigen::Index>(right.size()));
    figures_["accuracy"].sampled = IntervalOfShare(values, Sample(labelled));
  }

  Status AddSpread(const ScoredRows& row, int repetition) {
    Random random(seed(), "pairs", std::to_string(repetition));
    const auto pairs = static_cast<int>(options_.metrics.diversity_pairs);
    const IndexPairs any = DrawDiversityPairs(static_cast<int>(row.rows.size()), pairs, random);
    const double diversity = MeanDistance(row.features, any);
    figures_["diversity"].values.push_back(diversity);
    if (repetition == 0) within_labels_ = AddPairDistances(Sample(DistinctClips(row_, row.rows)), pairs, figures_);
    const bool all = options_.metrics.divisor == MultimodalityDivisor::kAll;
    if (labelled_ == 0 || (absent_ > 0 && !all)) {
      figures_["multimodality"].why = labelled_ == 0 ? "no_labels" : "class_without_motions";
      return {};
    }
    const auto quota = static_cast<int>(options_.metrics.multimodality_quota);
    const IndexPairs same = DrawMultimodalityPairs(row.labels, row_.class_count(), quota, random);
    const double whole = static_cast<double>(quota) * row_.class_count();
    if (!all && static_cast<double>(same.size()) < whole) {
      if (repetition == 0) {
        figures_["multimodality"].why = "class_without_motions";
        Warn("class_without_motions",
             "a repetition drew no motion of a class: multimodality is null; draw more motions");
      }
      return {};
    }
    if (OneEach(row.labels)) {
      figures_["multimodality"].why = "one_motion_of_a_class";
      return {};
    }
    const double weight = static_cast<double>(same.size()) / whole;
    figures_["multimodality"].values.push_back(MeanDistance(row.features, same) * weight);
    if (repetition == 0 && weight == 1.0 && within_labels_) {
      figures_["multimodality"].sampled =
          within_labels_->About(figures_["multimodality"].values.front(), static_cast<int>(same.size()));
    }
    return {};
  }

  /// Whether no class has two motions: every pair would be a motion with itself.
  static bool OneEach(std::vector<int> labels) {
    labels.erase(std::remove(labels.begin(), labels.end(), -1), labels.end());
    std::sort(labels.begin(), labels.end());
    return std::adjacent_find(labels.begin(), labels.end()) == labels.end();
  }

  void AddQuality(const ScoredRows& row) {
    for (const auto& [name, values] : row_.quality) {
      std::vector<int> measured;
      for (const int at : row.rows) {
        if (values[static_cast<std::size_t>(at)] >= 0.0) measured.push_back(at);
      }
      if (measured.empty()) continue;
      Eigen::VectorXd own(static_cast<Eigen::Index>(measured.size()));
      for (std::size_t i = 0; i < measured.size(); ++i) {
        own(static_cast<Eigen::Index>(i)) = values[static_cast<std::size_t>(measured[i])];
      }
      figures_[name].values = {own.mean()};
      figures_[name].sampled = IntervalOfMean(own, Sample(measured));
    }
  }

  Status AddFid(const std::string& name, const Features& row, const Features& reference, int repetition) {
    if (std::min(row.rows(), reference.rows()) < 2) {
      figures_[name].why = "too_few_motions";
      return {};
    }
    const auto distance = FidOf(row, reference);
    if (!distance) return Forward(distance);
    figures_[name].values.push_back(*distance);
    if (repetition > 0) return {};
    const Eigen::Index fewest = std::min(row.rows(), reference.rows());
    if (fewest <= row.cols()) {
      Warn("too_few_for_fid", name + ": " + std::to_string(fewest) + " motions for " + std::to_string(row.cols()) +
                                  " features: the covariance is rank-deficient and FID is biased upwards; use KID, or "
                                  "score more motions");
    }
    return {};
  }

  nlohmann::json Json() const {
    nlohmann::json metrics = nlohmann::json::object();
    for (const std::string& name : MetricNames()) {
      const auto figure = figures_.find(name);
      metrics[name] = JsonOf(figure == figures_.end() ? Figure() : figure->second, options_.draw.interval);
      if (metrics[name]["value"].is_null() && !metrics[name].contains("why")) metrics[name]["why"] = WhyNot(name);
    }
    nlohmann::json json = {{"name", options_.name}, {"real", real()},        {"motions", motions_},
                           {"metrics", metrics},    {"warnings", warnings_}, {"assumed", nlohmann::json::array()}};
    if (real() && !drawn()) json["assumed"].push_back("real_in_two_halves");
    if (confusion_.size() > 0) {
      for (Eigen::Index r = 0; r < confusion_.rows(); ++r) {
        std::vector<int> line;
        for (Eigen::Index c = 0; c < confusion_.cols(); ++c) line.push_back(confusion_(r, c));
        json["confusion"].push_back(line);
      }
    }
    return json;
  }

  /// Every row has these, null where they cannot be computed, and the other measures that it has.
  std::set<std::string> MetricNames() const {
    std::set<std::string> names = {"FID_train",
                                   "FID_test",
                                   "FID_equal",
                                   "FID_inf",
                                   "FID_normalised",
                                   "KID",
                                   "accuracy",
                                   "accuracy_top5",
                                   "diversity",
                                   "multimodality",
                                   "APD",
                                   "ACPD",
                                   "density",
                                   "coverage",
                                   "precision",
                                   "recall",
                                   "nearest_train",
                                   "memorised",
                                   "movement",
                                   "movement_of_real",
                                   "foot_skate",
                                   "floor_penetration",
                                   "jerk",
                                   "bone_spread",
                                   "limit_violations",
                                   "frozen_share"};
    if (!equivalent_.empty()) names.insert({"accuracy_equivalent", "accuracy_top5_equivalent"});
    for (const auto& [name, figure] : figures_) names.insert(name);
    return names;
  }

  /// Of a metric that nothing was computed of.
  std::string WhyNot(const std::string& name) const {
    if (name.rfind("accuracy", 0) == 0) return "no_labels";
    if (name == "FID_test") return references_.test == nullptr ? "no_reference" : "too_few_motions";
    const bool measured = row_.quality.count(name) > 0;
    if (measured || references_.train != nullptr) return "not_measured";
    return "no_reference";
  }

  const ScoreOptions& options_;
  const FeatureSet& row_;
  const References& references_;
  EquivalentClasses equivalent_;
  Figures figures_;
  std::optional<PairDistances> within_labels_;  ///< of the first repetition
  Eigen::MatrixXi confusion_;
  nlohmann::json warnings_ = nlohmann::json::array();
  int motions_ = 0;
  int labelled_ = 0;
  int absent_ = 0;
};

}  // namespace

ScoredRows RowsOfRepetition(const FeatureSet& set, const DrawOptions& draw, std::uint64_t seed, int repetition,
                            const std::string& purpose) {
  if (set.passes() > 1) {
    const int pass = std::min(repetition, set.passes() - 1);
    std::vector<int> rows(
        static_cast<std::size_t>(set.pass_end(pass) - set.pass_begin[static_cast<std::size_t>(pass)]));
    std::iota(rows.begin(), rows.end(), static_cast<int>(set.pass_begin[static_cast<std::size_t>(pass)]));
    return TakeRows(set, std::move(rows));
  }
  if (draw.per_label > 0) {
    return TakeRows(set, DrawPerLabel(set.label, static_cast<int>(draw.per_label), seed, repetition, purpose));
  }
  const bool real = purpose != "generated";
  return TakeRows(set, DrawPositions(set.count(), static_cast<int>(draw.motions), real && draw.replacement, seed,
                                     repetition, purpose));
}

Expected<nlohmann::json> ScoreRow(const ScoreOptions& options, const FeatureSet& row, const References& references) {
  return RowScore(options, row, references).Run();
}

Expected<nlohmann::json> CompareRows(const ScoreOptions& options, const FeatureSet& a, const FeatureSet& b,
                                     const FeatureSet& reference) {
  nlohmann::json metrics = nlohmann::json::object();
  if (a.feature_size > kLargestResampled) return metrics;
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const auto sample = [&](const FeatureSet& set, const char* purpose, bool real) {
    const ScoredRows rows = RowsOfRepetition(set, options.draw, seed, 0, purpose);
    return SampleOf(set, DistinctClips(set, rows.rows), real);
  };
  const FeatureSample first = sample(a, "generated", false), second = sample(b, "generated", false);
  if (std::min(first.count(), second.count()) < 2) return metrics;
  Random random(seed, "exchanges");
  const auto compared =
      DifferenceOfFids(first, second, sample(reference, "reference", true).features, kExchanges, random);
  if (!compared) return Forward(compared);
  metrics["FID_train"] = {{"difference", compared->difference}, {"p", compared->p}, {"motions", compared->motions}};
  return metrics;
}

}  // namespace mocurate
