#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>

#include "report/charts.h"
#include "report/run_facts.h"

namespace mocurate {
namespace {

/// A plotted metric; of `FID_equal` each row states that of real motions, with its standard deviation.
struct Learned {
  const char* metric;
  const char* title;
  bool decades;
};
constexpr Learned kLearned[] = {{"FID_equal", "FID, equal sizes (less is better)", true},
                                {"KID", "KID (less is better)", false},
                                {"accuracy", "Accuracy (more is better)", false},
                                {"movement_of_real", "Movement, of real motions (1 is as they move)", false}};

constexpr const char* kRealBand = "Real ± sd";

const nlohmann::json& MetricOf(const nlohmann::json& row, const char* metric) {
  return Field(Field(row, "metrics"), metric);
}

std::optional<PlotPoint> PointOf(const nlohmann::json& row, const char* metric, double x) {
  const nlohmann::json& found = MetricOf(row, metric);
  const auto value = NumberOf(found, "value");
  if (!value) return std::nullopt;
  PlotPoint point{x, *value};
  const std::vector<double> interval = NumbersOf(Field(found, "interval"));
  if (interval.size() == 2) std::tie(point.low, point.high) = std::pair(interval[0], interval[1]);
  return point;
}

/// The steps of a network's row, and the network without its sample's step: "ACTOR/1, 8 frames" of
/// "ACTOR/1@3700, 8 frames".
struct Sample {
  std::string network;
  double steps = 0.0;
  const nlohmann::json* row = nullptr;
};

void AddSamples(const nlohmann::json& row, std::vector<Sample>& samples) {
  for (const nlohmann::json& seed : Elements(Field(row, "seeds"))) AddSamples(seed, samples);
  const auto steps = NumberOf(Field(row, "ours"), "steps");
  if (!Elements(Field(row, "seeds")).empty() || !steps) return;
  std::string name = TextOf(row, "name");
  if (const std::size_t at = name.rfind('@'); at != std::string::npos) {
    name.erase(at, name.find_first_not_of("0123456789", at + 1) - at);
  }
  samples.push_back({name, *steps, &row});
}

/// Real motions, and yardsticks made of them.
bool IsLevel(const nlohmann::json& row) { return Field(row, "real") == true || Field(row, "given") == "motions"; }

/// The same value at all steps.
std::optional<PlotCurve> Level(const nlohmann::json& row, const char* metric, double end) {
  std::optional<PlotPoint> point = PointOf(row, metric, 0.0);
  const bool real = Field(row, "real").is_boolean() && Field(row, "real").get<bool>();
  if (real && metric == std::string("movement_of_real") && TextOf(row, "name") == "Real") point = PlotPoint{0.0, 1.0};
  if (!point) return std::nullopt;
  if (TextOf(row, "name") != "Real") point->low = point->high = std::nullopt;  // one band to compare with
  PlotPoint last = *point;
  last.x = end;
  return PlotCurve{TextOf(row, "name"), {*point, last}};
}

Plot PlotOf(const Learned& learned, const nlohmann::json& rows, const std::map<std::string, std::vector<Sample>>& of,
            double end) {
  Plot plot{learned.title, "training step", ""};
  for (const auto& [network, samples] : of) {
    PlotCurve curve{network, {}};
    for (const Sample& sample : samples) {
      if (const auto point = PointOf(*sample.row, learned.metric, sample.steps)) curve.points.push_back(*point);
    }
    if (curve.points.size() > 1) plot.curves.push_back(std::move(curve));
  }
  if (plot.curves.empty()) return plot;
  const bool equal = learned.metric == std::string("FID_equal");
  const nlohmann::json& fid = MetricOf(*of.begin()->second.back().row, learned.metric);
  if (equal) {  // with as many motions as the rows have
    if (const auto real = NumberOf(fid, "real")) {
      const double sd = NumberOf(fid, "real_sd").value_or(0.0);
      plot.curves.push_back({kRealBand, {{0.0, *real, *real - sd, *real + sd}, {end, *real, *real - sd, *real + sd}}});
    }
  }
  for (const nlohmann::json& row : rows) {
    if (!IsLevel(row) || (equal && TextOf(row, "name") == "Real")) continue;
    if (equal && Field(MetricOf(row, learned.metric), "motions") != Field(fid, "motions")) continue;  // FID of others
    if (auto level = Level(row, learned.metric, end)) plot.curves.push_back(*std::move(level));
  }
  if (!learned.decades) return plot;
  double least = HUGE_VAL, most = 0.0;  // of positive values; others are drawn at the lower edge
  for (const PlotCurve& curve : plot.curves) {
    for (const PlotPoint& point : curve.points) {
      if (point.y > 0.0) least = std::min(least, point.y);
      most = std::max(most, point.high.value_or(point.y));
    }
  }
  if (most <= 0.0) return plot;
  const double low = std::floor(std::log10(std::min(least, most)));
  plot.decades = {low, std::max(low + 1.0, std::ceil(std::log10(most)))};
  return plot;
}

}  // namespace

std::optional<PlotSheet> LearningSheet(const nlohmann::json& rows, const std::string& title) {
  std::vector<Sample> samples;
  for (const nlohmann::json& row : Elements(rows)) AddSamples(row, samples);
  std::map<std::string, std::vector<Sample>> of_network;
  double end = 0.0;
  for (const Sample& sample : samples) {
    of_network[sample.network].push_back(sample);
    end = std::max(end, sample.steps);
  }
  for (auto& [network, own] : of_network) {
    std::sort(own.begin(), own.end(), [](const Sample& a, const Sample& b) { return a.steps < b.steps; });
  }
  std::set<std::string> kinds;  // of intervals
  for (const Sample& sample : samples) {
    for (const Learned& learned : kLearned)
      kinds.insert(TextOf(MetricOf(*sample.row, learned.metric), "interval_kind"));
  }
  kinds.erase("");
  PlotSheet sheet{title, "", "", {}, 2};
  for (const std::string& kind : kinds) sheet.note += (sheet.note.empty() ? "Bands: " : ", ") + kind;
  std::map<std::string, int> colours;  // the same in each plot
  for (const auto& [network, own] : of_network) colours.emplace(network, static_cast<int>(colours.size()));
  for (const nlohmann::json& row : Elements(rows)) {
    if (IsLevel(row)) colours.emplace(TextOf(row, "name"), static_cast<int>(colours.size()));
  }
  for (const Learned& learned : kLearned) {
    Plot plot = PlotOf(learned, rows, of_network, end);
    for (PlotCurve& curve : plot.curves) {
      const auto colour = colours.find(curve.name == kRealBand ? "Real" : curve.name);
      if (colour != colours.end()) curve.colour = colour->second;
    }
    if (!plot.curves.empty()) sheet.plots.push_back(std::move(plot));
  }
  if (sheet.plots.empty()) return std::nullopt;
  return sheet;
}

}  // namespace mocurate
