#include "eval/tables/metric_columns.h"

#include <nlohmann/json.hpp>

namespace mocurate {

const std::vector<MetricColumn>& MetricColumns() {
  static const std::vector<MetricColumn> kColumns = {
      {"FID_train", "FID train ↓", 3, Better::kLess},
      {"FID_test", "FID test ↓", 3, Better::kLess},
      {"accuracy", "Accuracy ↑", 3, Better::kMore},
      {"accuracy_denoised", "Accuracy, denoised ↑", 3, Better::kMore},
      {"accuracy_top5", "Top-5 ↑", 3, Better::kMore},
      {"accuracy_equivalent", "Accuracy, equivalent labels ↑", 3, Better::kMore},
      {"diversity", "Diversity →", 3, Better::kNearReal},
      {"multimodality", "Multimodality →", 3, Better::kNearReal},
      {"KID", "KID ↓", 4, Better::kLess},
      {"density", "Density →", 3, Better::kNearReal},
      {"coverage", "Coverage ↑", 3, Better::kMore},
      {"nearest_train", "Nearest in train →", 3, Better::kNearReal},
      {"foot_skate", "Foot skate, m/s ↓", 3, Better::kLess},
      {"floor_penetration", "Below floor, m ↓", 4, Better::kLess},
      {"jerk", "Jerk, m/s³", 1, Better::kNone},
      {"bone_spread", "Bone spread, m ↓", 4, Better::kLess},
      {"limit_violations", "Beyond limits ↓", 4, Better::kLess},
      {"frozen_share", "Frozen ↓", 3, Better::kLess},
      {"parameters", "Parameters", 0, Better::kNone},
      {"clips", "Clips", 0, Better::kNone}};
  return kColumns;
}

Table::Cell CellOf(const nlohmann::json& metric) {
  Table::Cell cell;
  if (!metric.is_object() || !metric.at("value").is_number()) return cell;
  cell.value = metric["value"].get<double>();
  if (metric.contains("interval") && metric["interval"].is_array()) {
    cell.interval = metric["interval"].get<std::array<double, 2>>();
    cell.interval_kind = metric.value("interval_kind", std::string());
  }
  cell.repetitions = metric.value("repetitions", std::vector<double>());
  return cell;
}

}  // namespace mocurate
