#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "report/charts.h"

namespace mocurate {
namespace {

/// Plotted metrics, in an order that separates similar colours.
constexpr const char* kDrawn[] = {"FID_train",     "KID",        "accuracy", "diversity",   "multimodality",
                                  "nearest_train", "foot_skate", "jerk",     "bone_spread", "coverage"};

/// The reference that a metric's values are divided by; nothing where it has no value.
std::optional<double> UnitOf(const nlohmann::json& real, const std::string& metric, const nlohmann::json& values) {
  constexpr double kNothing = 1e-6, kSmall = 1e-3;  // kSmall: for bones, a millimetre
  std::optional<double> undamaged;
  for (const nlohmann::json& value : values) {
    if (value.at("metric") == metric && value.at("undamaged").get<bool>()) undamaged = value.at("value").get<double>();
  }
  // Distances to the same motions are 0 up to rounding, and KID's estimate may be negative.
  const bool distance = metric == "FID_train" || metric == "FID_test" || metric == "KID" || metric == "nearest_train";
  if (!distance && undamaged && std::abs(*undamaged) > kNothing) return undamaged;
  if (const double value = std::abs(real.value(metric, 0.0)); value > kNothing) return value;
  return undamaged ? std::optional(kSmall) : std::nullopt;
}

}  // namespace

PlotSheet DoseSheet(const nlohmann::json& dose, const std::string& title) {
  PlotSheet sheet{title,
                  "Multiples of the undamaged motions' value; of FID, KID and nearest_train of real motions among each "
                  "other; of 0.001 where that is 0. Large dots: the metric responds.",
                  "",
                  {},
                  2};
  std::vector<std::string> damages;
  std::map<std::string, nlohmann::json> values_of;
  for (const nlohmann::json& value : dose.at("values")) {
    const auto damage = value.at("damage").get<std::string>();
    if (values_of.count(damage) == 0) damages.push_back(damage);
    values_of[damage].push_back(value);
  }
  for (const std::string& damage : damages) {
    std::map<double, double> place_of;  // of each dose on the axis
    for (const nlohmann::json& value : values_of[damage]) place_of[value.at("dose").get<double>()] = 0.0;
    Plot plot{damage, values_of[damage].front().at("unit"), ""};
    plot.decades = {-1.0, 3.0};
    for (auto& [amount, place] : place_of) {
      place = static_cast<double>(plot.x_texts.size());
      plot.x_texts.push_back(FormatDouble(amount));
    }
    for (std::size_t k = 0; k < std::size(kDrawn); ++k) {
      const auto unit = UnitOf(dose.at("real"), kDrawn[k], values_of[damage]);
      if (!unit) continue;
      std::map<double, PlotPoint> points;
      for (const nlohmann::json& value : values_of[damage]) {
        if (value.at("metric") != kDrawn[k]) continue;
        const double x = place_of.at(value.at("dose").get<double>());
        points[x] = {x, value.at("value").get<double>() / *unit, {}, {}, value.at("answers").get<bool>()};
      }
      PlotCurve curve{kDrawn[k], {}, static_cast<int>(k)};
      for (const auto& [x, point] : points) curve.points.push_back(point);
      plot.curves.push_back(std::move(curve));
    }
    sheet.plots.push_back(std::move(plot));
  }
  return sheet;
}

}  // namespace mocurate
