#include "eval/protocols/score.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "core/base/text.h"
#include "eval/metrics/accuracy.h"
#include "eval/metrics/feature_distances.h"
#include "eval/metrics/interval.h"
#include "eval/protocols/draws.h"

namespace mocurate {
namespace {

/// Above this size a resample of FID takes seconds: D x D eigenvalues.
constexpr int kLargestResampled = 128;
constexpr int kSignChanges = 10000;  // for a p of repetitions
constexpr int kResamples = 200;      // of bootstrap intervals, and permutations of comparisons
constexpr int kKidSubsets = 10;
constexpr int kKidSize = 1000;  // motions of a subset
constexpr int kNeighbours = 5;  // k of density and coverage

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

Features RowsAt(const Features& features, const std::vector<int>& rows) {
  Features taken(static_cast<Eigen::Index>(rows.size()), features.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) taken.row(static_cast<Eigen::Index>(i)) = features.row(rows[i]);
  return taken;
}

Expected<double> FidOf(const Features& a, const Features& b) {
  const auto first = StatisticsOf(a);
  if (!first) return Forward(first);
  const auto second = StatisticsOf(b);
  if (!second) return Forward(second);
  return FrechetDistance(*first, *second);
}

/// `unknown`: names in the table that are not classes of the extractor.
EquivalentClasses EquivalentOf(const ScoreOptions& options, const std::vector<std::string>& classes,
                               std::set<std::string>& unknown) {
  EquivalentClasses equivalent;
  if (options.equivalent.empty()) return equivalent;
  equivalent.resize(classes.size());
  const auto at = [&](const std::string& name) {
    const auto found = std::find(classes.begin(), classes.end(), name);
    return found == classes.end() ? -1 : static_cast<int>(found - classes.begin());
  };
  for (const auto& [truth, accepted] : options.equivalent) {
    if (at(truth) < 0) {
      unknown.insert(truth);
      continue;
    }
    for (const std::string_view part : SplitText(accepted, ',')) {
      const std::string name(Trim(part));
      if (at(name) >= 0) {
        equivalent[static_cast<std::size_t>(at(truth))].push_back(at(name));
      } else {
        unknown.insert(name);
      }
    }
  }
  return equivalent;
}

/// One metric: values of the repetitions, and the interval from resampling the motions of the first one.
struct Figure {
  std::vector<double> values;
  std::optional<std::array<double, 2>> interval;
};

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
    equivalent_ = EquivalentOf(options_, row_.classes, unknown);
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
    AddAccuracy(row);
    if (Status spread = AddSpread(row, repetition); !spread) return spread;
    if (repetition == 0) AddQuality(row);
    const std::pair<const char*, const FeatureSet*> sides[] = {{"FID_train", references_.train},
                                                               {"FID_test", references_.test}};
    for (const auto& [name, reference_set] : sides) {
      if (reference_set == nullptr) continue;
      const bool train = reference_set == references_.train;
      const bool itself = options_.real == (train ? RealRow::kTrain : RealRow::kTest);
      std::pair<ScoredRows, ScoredRows> halves;
      if (itself && (!drawn() || repetition == 0)) halves = Halves(row.rows, repetition);
      ScoredRows reference = itself && !drawn()
                                 ? halves.second
                                 : RowsOfRepetition(*reference_set, options_.draw, seed(), repetition, "reference");
      const Features& compared = itself && !drawn() ? halves.first.features : row.features;
      if (Status added = AddDistances(name, compared, reference.features, repetition); !added) return added;
      if (repetition > 0 || !train) continue;
      if (itself) {  // otherwise each motion is its own neighbour
        AddNeighbours(halves.first.features, halves.second.features);
      } else {
        AddNeighbours(Gather(row_, DistinctClips(row_, row.rows)),
                      Gather(*reference_set, DistinctClips(*reference_set, reference.rows)));
      }
    }
    return {};
  }

  void AddAccuracy(const ScoredRows& row) {
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
    figures_["accuracy_top5"].values.push_back(AcceptedShare(row.labels, logits.data(), classes, 5, equivalent_));
    if (!equivalent_.empty()) {
      figures_["accuracy_equivalent"].values.push_back(
          AcceptedShare(row.labels, logits.data(), classes, 1, equivalent_));
    }
    const Eigen::MatrixXi confusion = ConfusionMatrix(row.labels, predicted, classes);
    confusion_ = confusion_.size() == 0 ? confusion : Eigen::MatrixXi(confusion_ + confusion);
    if (figures_["accuracy"].interval) return;  // of the first repetition
    std::vector<double> right;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      if (row.labels[i] >= 0) right.push_back(predicted[i] == row.labels[i] ? 1.0 : 0.0);
    }
    Random random(seed(), "resamples of accuracy");
    figures_["accuracy"].interval = CentralInterval(ResampledMeans(right, kResamples, random));
  }

  Status AddSpread(const ScoredRows& row, int repetition) {
    Random random(seed(), "pairs", std::to_string(repetition));
    const IndexPairs any = DrawDiversityPairs(static_cast<int>(row.rows.size()),
                                              static_cast<int>(options_.metrics.diversity_pairs), random);
    figures_["diversity"].values.push_back(MeanDistance(row.features, any));
    const bool all = options_.metrics.divisor == MultimodalityDivisor::kAll;
    if (labelled_ == 0 || (absent_ > 0 && !all)) return {};
    const auto quota = static_cast<int>(options_.metrics.multimodality_quota);
    const IndexPairs same = DrawMultimodalityPairs(row.labels, row_.class_count(), quota, random);
    const double whole = static_cast<double>(quota) * row_.class_count();
    if (!all && static_cast<double>(same.size()) < whole) {
      if (repetition == 0) {
        Warn("class_without_motions",
             "a repetition drew no motion of a class: multimodality is null; draw more motions");
      }
      return {};
    }
    const double mean = MeanDistance(row.features, same);
    figures_["multimodality"].values.push_back(mean * static_cast<double>(same.size()) / whole);
    return {};
  }

  void AddQuality(const ScoredRows& row) {
    for (const auto& [name, values] : row_.quality) {
      std::vector<double> own;
      for (const int at : row.rows) {
        if (values[static_cast<std::size_t>(at)] >= 0.0) own.push_back(values[static_cast<std::size_t>(at)]);
      }
      if (own.empty()) continue;
      const double mean = std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(own.size());
      Random random(seed(), "resamples of quality", name);
      figures_[name] = {{mean}, CentralInterval(ResampledMeans(own, kResamples, random))};
    }
  }

  Status AddDistances(const std::string& name, const Features& row, const Features& reference, int repetition) {
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
    figures_[name].interval = ResampledFid(name, row, reference);
    return {};
  }

  /// Metrics beside the papers', of the first repetition.
  void AddNeighbours(const Features& row, const Features& reference) {
    Random random(seed(), "subsets of KID");
    if (const auto kid = KernelDistance(row, reference, kKidSubsets, kKidSize, random)) {
      figures_["KID"].values = {*kid};
    }
    if (const auto near = CompareNeighbours(row, reference, kNeighbours)) {
      figures_["density"].values = {near->density};
      figures_["coverage"].values = {near->coverage};
      figures_["nearest_train"].values = {near->nearest};
    }
  }

  /// 95 % interval of the FIDs of resampled motions, shifted to remove the bias of resampling (repeated rows).
  std::optional<std::array<double, 2>> ResampledFid(const std::string& name, const Features& row,
                                                    const Features& reference) const {
    if (row.cols() > kLargestResampled) return std::nullopt;
    Random random(seed(), "resamples of " + name);
    std::vector<double> values;
    const auto resample = [&](const Features& features) {
      std::vector<int> rows(static_cast<std::size_t>(features.rows()));
      for (int& at : rows) at = static_cast<int>(random.Below(static_cast<std::uint64_t>(features.rows())));
      return RowsAt(features, rows);
    };
    for (int i = 0; i < kResamples; ++i) {
      const Features a = resample(row), b = resample(reference);
      if (const auto value = FidOf(a, b)) values.push_back(*value);
    }
    if (values.size() < 2) return std::nullopt;
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    const double seen = figures_.at(name).values.front();
    auto interval = *CentralInterval(std::move(values));
    for (double& end : interval) end = std::max(0.0, end - mean + seen);
    return interval;
  }

  nlohmann::json Json() const {
    const std::vector<std::string> names = MetricNames();
    nlohmann::json metrics = nlohmann::json::object();
    for (const std::string& name : names) {
      const auto figure = figures_.find(name);
      if (figure == figures_.end() || figure->second.values.empty()) {
        metrics[name] = {{"value", nullptr}, {"interval", nullptr}, {"interval_kind", nullptr}};
        continue;
      }
      const std::vector<double>& values = figure->second.values;
      const Summary summary = Summarise(values, options_.draw.interval);
      nlohmann::json one = {{"value", summary.mean}, {"interval", nullptr}, {"interval_kind", nullptr}};
      if (values.size() > 1) {
        one["interval"] = {summary.mean - summary.half_width, summary.mean + summary.half_width};
        one["interval_kind"] = Name(options_.draw.interval);
        one["repetitions"] = values;
      } else if (figure->second.interval) {
        one["interval"] = *figure->second.interval;
        one["interval_kind"] = Name(IntervalKind::kBootstrap);
      }
      if (figure->second.interval) one["bootstrap_95"] = *figure->second.interval;
      metrics[name] = std::move(one);
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

  static std::vector<std::string> MetricNames() {
    return {"FID_train",         "FID_test", "accuracy",    "accuracy_top5",    "accuracy_equivalent", "diversity",
            "multimodality",     "KID",      "density",     "coverage",         "nearest_train",       "foot_skate",
            "floor_penetration", "jerk",     "bone_spread", "limit_violations", "frozen_share"};
  }

  const ScoreOptions& options_;
  const FeatureSet& row_;
  const References& references_;
  EquivalentClasses equivalent_;
  std::map<std::string, Figure> figures_;
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
  const auto seed = static_cast<std::uint64_t>(options.seed);
  nlohmann::json metrics = nlohmann::json::object();
  if (options.draw.repetitions > 1) {
    std::vector<double> first, second;
    for (int r = 0; r < static_cast<int>(options.draw.repetitions); ++r) {
      const Features against = RowsOfRepetition(reference, options.draw, seed, r, "reference").features;
      const auto of_a = FidOf(RowsOfRepetition(a, options.draw, seed, r, "generated").features, against);
      const auto of_b = FidOf(RowsOfRepetition(b, options.draw, seed, r, "generated").features, against);
      if (!of_a) return Forward(of_a);
      if (!of_b) return Forward(of_b);
      first.push_back(*of_a);
      second.push_back(*of_b);
    }
    Random random(seed, "signs");
    const auto mean = [](const std::vector<double>& values) {
      return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    };
    metrics["FID_train"] = {{"difference", mean(first) - mean(second)}, {"p", nullptr}};
    if (options.fresh) metrics["FID_train"]["p"] = PairedSignTest(first, second, kSignChanges, random);
    return metrics;
  }
  if (a.count() != b.count() || a.feature_size > kLargestResampled) return metrics;
  std::vector<int> all(static_cast<std::size_t>(a.count()));
  std::iota(all.begin(), all.end(), 0);
  const Features first = Gather(a, all), second = Gather(b, all);
  std::vector<int> of_reference(static_cast<std::size_t>(reference.count()));
  std::iota(of_reference.begin(), of_reference.end(), 0);
  const auto against = StatisticsOf(Gather(reference, of_reference));
  if (!against) return Forward(against);
  const auto difference = [&](const std::vector<bool>& exchanged) {
    Features x = first, y = second;
    for (std::size_t i = 0; i < exchanged.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      if (exchanged[i]) x.row(at).swap(y.row(at));
    }
    const auto of_x = StatisticsOf(x), of_y = StatisticsOf(y);
    if (!of_x || !of_y) return 0.0;
    return FrechetDistance(*of_x, *against).value_or(0.0) - FrechetDistance(*of_y, *against).value_or(0.0);
  };
  Random random(seed, "exchanges");
  metrics["FID_train"] = {{"difference", difference(std::vector<bool>(all.size(), false))},
                          {"p", PairedExchangeTest(a.count(), kResamples, difference, random)}};
  return metrics;
}

}  // namespace mocurate
