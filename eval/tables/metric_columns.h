#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "eval/tables/table.h"

namespace mocurate {

/// Direction in which a metric is better; kNearReal: near that of real motions.
enum class Better { kLess, kMore, kNearReal, kNone };

/// A metric as a column of tables.
struct MetricColumn {
  const char* key;
  const char* title;  ///< with an arrow towards better values
  int digits;
  Better better;
};

/// All metrics, in the order of columns.
const std::vector<MetricColumn>& MetricColumns();

/// {"value", "interval", "interval_kind", "repetitions"} as a cell; empty where there is no number.
Table::Cell CellOf(const nlohmann::json& metric);

}  // namespace mocurate
