#include "eval/published/published.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/table_text.h"
#include "core/base/text.h"
#include "eval/metrics/interval.h"

namespace mocurate {
namespace {

constexpr std::size_t kPublishedFields = 9;

/// Half a unit of the last decimal: "0.092" -> 0.0005.
double HalfUnitOf(const std::string& number) {
  const std::size_t point = number.find('.');
  return 0.5 * std::pow(10.0, point == std::string::npos ? 0.0 : -static_cast<double>(number.size() - point - 1));
}

}  // namespace

Expected<nlohmann::json> PublishedOf(std::string_view csv, const std::string& name, const std::string& paper,
                                     const std::string& dataset) {
  nlohmann::json own = nlohmann::json::array(), others = nlohmann::json::array();
  int line_number = 0;
  for (const std::string_view line : SplitText(csv, '\n')) {
    ++line_number;
    if (line_number == 1 || line.empty()) continue;
    const std::vector<std::string> fields = CellsOfCsvLine(line).value_or(std::vector<std::string>());
    const auto number = fields.size() == kPublishedFields ? ParseDouble(fields[5]) : std::nullopt;
    if (!number) {
      return Fail(ErrorCode::kMalformed,
                  std::to_string(fields.size()) + " fields, " + std::to_string(kPublishedFields) +
                      " with a number are required",
                  name + ":" + std::to_string(line_number),
                  "write paper,table,dataset,method,metric,value,pm,pm_kind,source");
    }
    if (fields[2] != dataset) continue;
    const auto pm = ParseDouble(fields[6]);
    // The papers print both with the same digits; ACTOR's accuracies are percent and percent squared.
    const double rounding = HalfUnitOf(fields[5]);
    const bool squared = fields[4] == "accuracy" && fields[7] == Name(IntervalKind::kActor);
    (fields[0] == paper ? own : others)
        .push_back({{"method", fields[3]},
                    {"paper", fields[0]},
                    {"dataset", fields[2]},
                    {"metric", fields[4]},
                    {"value", *number},
                    {"pm", pm ? nlohmann::json(*pm) : nlohmann::json()},
                    {"pm_kind", fields[7]},
                    {"table", fields[1]},
                    {"source", fields[8]},
                    {"rounding", rounding},
                    {"pm_rounding", rounding * (squared ? 0.01 : 1.0)}});
  }
  for (nlohmann::json& value : others) own.push_back(std::move(value));
  return own;
}

nlohmann::json OfTransitions(const nlohmann::json& published, bool transitions) {
  const std::string ending = "_transition";
  nlohmann::json chosen = nlohmann::json::array();
  for (nlohmann::json value : published) {
    const std::string metric = value.at("metric").get<std::string>();
    const std::size_t end = metric.size() - std::min(metric.size(), ending.size());
    const bool of_transition = metric.substr(end) == ending;
    if (of_transition != transitions) continue;
    if (of_transition) value["metric"] = metric.substr(0, end);
    chosen.push_back(std::move(value));
  }
  return chosen;
}

}  // namespace mocurate
