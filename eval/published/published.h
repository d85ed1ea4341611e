#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// One number of a paper's table, in our metrics' names and units (accuracy as a fraction).
struct PublishedValue {
  std::string paper, table, dataset, method, metric;
  double value = 0.0;
  std::optional<double> pm;
  std::string pm_kind;  ///< meaning of the paper's +-: a Name(IntervalKind)
  std::string source;
  double rounding = 0.0;     ///< half a unit of the value's last printed digit
  double pm_rounding = 0.0;  ///< and of the +-
};

/// Reads configs/published/tables.csv. Error kMalformed "name:line".
Expected<std::vector<PublishedValue>> ParsePublished(std::string_view csv, const std::string& name);

/// The published numbers of a data set, the paper's own first: [{"method", "dataset", "metric", "value", "pm",
/// "pm_kind", "table", "source", "rounding", "pm_rounding"}].
nlohmann::json PublishedOf(const std::vector<PublishedValue>& values, const std::string& paper,
                           const std::string& dataset);

/// Of a list as of PublishedOf: those of a table of transitions under the metrics' plain names (FID_train_transition ->
/// FID_train), or all others.
nlohmann::json OfTransitions(const nlohmann::json& published, bool transitions);

}  // namespace mocurate
