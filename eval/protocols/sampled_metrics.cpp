#include "eval/protocols/sampled_metrics.h"

#include <algorithm>

#include "core/base/random.h"
#include "core/motion/clip.h"

namespace mocurate {
namespace {

constexpr int kEqualDraws = 100;
constexpr int kEqualDrawsOfMany = 20;  // of more than kLargestResampled features, where a draw takes 0.1 s and more
constexpr int kKidSubsets = 10;
constexpr int kKidSize = 500;   // motions of a subset
constexpr int kNeighbours = 5;  // k of density and coverage

Figure Null(const char* why) {
  Figure figure;
  figure.why = why;
  return figure;
}

Status AddEqualSizes(const FeatureSample& row, const FeatureSample& real, bool itself, std::optional<double> p,
                     std::uint64_t seed, Figures& figures) {
  if (real.count() < 4 || row.count() < 2) {
    figures["FID_equal"] = Null("too_few_motions");
    return {};
  }
  const int draws = row.features.cols() > kLargestResampled ? kEqualDrawsOfMany : kEqualDraws;
  const auto fid = FidAtEqualSizes(itself ? nullptr : &row.features, real.features, draws, seed);
  if (!fid) return Forward(fid);
  Figure figure;
  figure.values = {fid->row};
  figure.more = {{"motions", fid->motions},
                 {"real", fid->real},
                 {"real_sd", fid->real_sd},
                 {"draws", fid->draws},
                 {"p", p ? nlohmann::json(*p) : nlohmann::json()}};
  figures["FID_equal"] = std::move(figure);
  return {};
}

Status AddKernel(const FeatureSample& row, const FeatureSample& reference, std::uint64_t seed, Figures& figures) {
  Random random(seed, "subsets of KID");
  const auto subsets = KernelDistance(row.features, reference.features, kKidSubsets, kKidSize, random);
  if (!subsets) return Forward(subsets);
  const auto all = KernelDistanceOfAll(row, reference);
  if (!all) return Forward(all);
  Figure figure;
  figure.values = {all->value};
  figure.sampled =
      IntervalAbout(all->value, all->variance, std::min(row.units, reference.units), KindOf(row, reference));
  figure.more = {
      {"subsets",
       {{"mean", subsets->mean}, {"sd", subsets->sd}, {"count", subsets->count}, {"motions", subsets->size}}}};
  figures["KID"] = std::move(figure);
  return {};
}

void AddNeighbours(const FeatureSample& row, const FeatureSample& reference, Figures& figures) {
  const auto near = CompareNeighbours(row.features, reference.features, kNeighbours);
  if (!near) {
    for (const char* name : {"density", "coverage", "precision", "recall", "nearest_train", "memorised"}) {
      figures[name] = Null("too_few_motions");
    }
    return;
  }
  figures["density"].values = {near->density};
  figures["coverage"].values = {near->coverage};
  figures["precision"].values = {near->precision};
  if (row.count() > kNeighbours) {
    figures["recall"].values = {near->recall};
  } else {
    figures["recall"] = Null("too_few_motions");
  }
  figures["memorised"].more = {{"own_nearest", near->own_nearest}};
  figures["nearest_train"].values = {near->nearest};
  figures["memorised"].values = {near->memorised};
}

}  // namespace

nlohmann::json JsonOf(const Figure& figure, IntervalKind kind) {
  nlohmann::json json = figure.more;
  for (const char* key : {"value", "interval", "interval_kind"}) json[key] = nullptr;
  if (!figure.why.empty()) json["why"] = figure.why;
  if (figure.values.empty()) return json;
  const Summary summary = Summarise(figure.values, kind);
  json["value"] = summary.mean;
  if (figure.values.size() > 1) {
    json["interval"] = {summary.mean - summary.half_width, summary.mean + summary.half_width};
    json["interval_kind"] = Name(kind);
    json["repetitions"] = figure.values;
  } else if (figure.sampled) {
    json["interval"] = figure.sampled->ends;
    json["interval_kind"] = Name(figure.sampled->kind);
  }
  if (figure.sampled) {
    json["sampled"] = {{"interval", figure.sampled->ends}, {"kind", Name(figure.sampled->kind)}};
  }
  return json;
}

FeatureSample SampleOf(const FeatureSet& set, const std::vector<int>& rows, bool real) {
  FeatureSample sample;
  sample.features.resize(static_cast<Eigen::Index>(rows.size()), set.feature_size);
  std::map<std::string, int> units;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto at = static_cast<std::size_t>(rows[i]);
    const float* row = set.features.data() + at * static_cast<std::size_t>(set.feature_size);
    for (int k = 0; k < set.feature_size; ++k) sample.features(static_cast<Eigen::Index>(i), k) = row[k];
    sample.label.push_back(set.label[at]);
    const std::string person = real ? PersonOf(set.clip[at]) : std::string();
    if (real && person.empty()) sample.independent = false;
    // Draws with replacement hold a clip several times: it is one unit.
    const std::string unit = person.empty() ? set.clip[at] : person;
    sample.unit.push_back(units.try_emplace(unit, static_cast<int>(units.size())).first->second);
  }
  sample.units = static_cast<int>(units.size());
  sample.persons = real && sample.independent;
  return sample;
}

Expected<std::optional<NoDifference>> AddFidInterval(const std::string& name, const FeatureSample& row,
                                                     const FeatureSample& reference, std::uint64_t seed,
                                                     Figures& figures) {
  if (row.features.cols() > kLargestResampled) figures[name].more["why_no_interval"] = "too_many_features";
  if (row.features.cols() > kLargestResampled || std::min(row.units, reference.units) < 2 ||
      std::min(row.count(), reference.count()) < 2) {
    return std::optional<NoDifference>();
  }
  Random random(seed, "exchanges of " + name);
  const auto none = FidsOfNoDifference(row, reference, kExchanges, random);
  if (!none) return Forward(none);
  const auto variance = FirstOrderVariance(row, reference);
  if (!variance) return Forward(variance);
  Figure& fid = figures[name];
  if (!fid.values.empty()) {
    fid.sampled = IntervalAbout(fid.values.front(), *variance + none->variance, std::min(row.units, reference.units),
                                KindOf(row, reference));
    if (fid.sampled) fid.sampled->ends[0] = std::max(0.0, fid.sampled->ends[0]);
  }
  return std::optional<NoDifference>(*none);
}

Status AddSampledMetrics(const FeatureSample& row, const FeatureSample& reference, const FeatureSample& real,
                         bool itself, std::uint64_t seed, Figures& figures) {
  if (std::min(row.count(), reference.count()) < 2) {
    for (const char* name : {"FID_equal", "FID_inf", "FID_normalised", "KID"}) figures[name] = Null("too_few_motions");
    AddNeighbours(row, reference, figures);
    return {};
  }
  const auto none = AddFidInterval("FID_train", row, reference, seed, figures);
  if (!none) return Forward(none);
  // The signs of few persons, or of persons that are not known, test nothing.
  const bool tested = *none && !itself && KindOf(row, reference) != SampledKind::kSpread;
  const std::optional<double> p = tested ? std::optional<double>((*none)->p) : std::nullopt;
  if (Status added = AddEqualSizes(row, real, itself, p, seed, figures); !added) return added;
  if (!itself && !tested) {
    figures["FID_equal"].more["why_no_p"] = *none ? "few_or_unknown_persons" : "too_many_features";
  }
  const auto limit = ExtrapolatedFid(row, reference, seed);
  if (!limit) return Forward(limit);
  figures["FID_inf"] = Null("too_few_motions");
  if (limit->has_value()) {
    const std::optional<SampledInterval> whole = figures["FID_train"].sampled;
    Figure figure;
    figure.values = {**limit};
    if (whole) {  // moved: the variance is the same
      const double half = whole->ends[1] - figures["FID_train"].values.front();
      figure.sampled = SampledInterval{{**limit - half, **limit + half}, whole->kind};
    }
    figures["FID_inf"] = std::move(figure);
  }
  const auto first = StatisticsOf(Normalised(row.features)), second = StatisticsOf(Normalised(reference.features));
  if (!first) return Forward(first);
  if (!second) return Forward(second);
  const auto normalised = FrechetDistance(*first, *second);
  if (!normalised) return Forward(normalised);
  figures["FID_normalised"].values = {*normalised};
  if (Status added = AddKernel(row, reference, seed, figures); !added) return added;
  AddNeighbours(row, reference, figures);
  if (itself) figures["nearest_train"] = Null("real_motions");  // 1 by its definition
  return {};
}

std::optional<PairDistances> AddPairDistances(const FeatureSample& sample, int pairs, Figures& figures) {
  const auto any = DistancesOfAll(sample, false), within = DistancesOfAll(sample, true);
  for (const auto& [name, distances] : {std::pair{"APD", any}, std::pair{"ACPD", within}}) {
    if (!distances) {
      const bool labelled = std::any_of(sample.label.begin(), sample.label.end(), [](int label) { return label >= 0; });
      figures[name].why = sample.count() < 2 ? "too_few_motions" : labelled ? "one_motion_of_a_class" : "no_labels";
      continue;
    }
    figures[name].values = {distances->mean};
    figures[name].sampled = distances->About(distances->mean, 0);
  }
  if (any) figures["diversity"].sampled = any->About(figures["diversity"].values.front(), pairs);
  return within;
}

std::optional<double> MovementOfReal(const FeatureSet& set, const std::vector<int>& rows, const FeatureSet& real,
                                     const std::vector<int>& real_rows) {
  const auto by_label = [](const FeatureSet& of, const std::vector<int>& chosen) {
    std::map<int, std::pair<double, double>> sums;
    const auto values = of.quality.find("movement");
    if (values == of.quality.end()) return sums;
    for (const int row : chosen) {
      const double value = values->second[static_cast<std::size_t>(row)];
      if (value < 0.0 || of.label[static_cast<std::size_t>(row)] < 0) continue;
      auto& [sum, count] = sums[of.label[static_cast<std::size_t>(row)]];
      sum += value;
      count += 1.0;
    }
    return sums;
  };
  const auto own = by_label(set, rows), theirs = by_label(real, real_rows);
  double sum = 0.0, labels = 0.0;
  for (const auto& [label, of_label] : own) {
    const auto other = theirs.find(label);
    if (other == theirs.end() || other->second.first <= 0.0) continue;
    sum += of_label.first / of_label.second / (other->second.first / other->second.second);
    labels += 1.0;
  }
  return labels == 0.0 ? std::nullopt : std::optional<double>(sum / labels);
}

}  // namespace mocurate
