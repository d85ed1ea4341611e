#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/tables/table.h"

namespace mocurate {

/// How our rows are matched with the published ones.
struct ComparisonOptions {
  std::string title;
  std::string profile;                              ///< appended to the name of each of our rows; empty: nothing
  std::map<std::string, std::string> published_as;  ///< row -> method; "": none
};

/// A published table with our numbers beside it.
struct Comparison {
  Table table;  ///< three columns a metric: ours, published, ours divided by published with its interval
  /// [{"method", "published_as", "profile", "metrics": {M: {"value", "interval", "interval_kind", "published",
  /// "published_pm", "pm_kind", "ratio", "ratio_interval", "why_no_ratio"}}}]
  nlohmann::json rows;
  /// [{"metric", "pairs", "as_published", "equal", "p"}]: pairs of rows of generated motions, how many of them are in
  /// the published order, in how many ours are equal, and Kendall's exact one-sided p of as many by chance; for metrics
  /// where less or more is better.
  nlohmann::json order = nlohmann::json::array();
};

/// {"rows", "published", "published_features": whether ours are of the published recogniser on the original data, or
/// metrics of features have no ratio} as of ResultTable. A row with a "profile" of its own is not ordered. A row NAME
/// or NAME/SEED is matched with the method NAME; Real with the paper's real motions. Unmatched rows have our value
/// alone, unmatched methods the published number alone. Unpublished metrics are omitted, unless nothing was published
/// at all.
Comparison ComparePublished(const nlohmann::json& result, const ComparisonOptions& options);

/// The first line of ComparisonCsv.
std::string ComparisonCsvHead();
/// The rows of a comparison in long form: set, method, published_as, profile, metric, value, its interval and kind, the
/// published value with its +- and kind, ratio and its interval; one line per number.
std::string ComparisonCsv(const std::string& set, const Comparison& comparison);

}  // namespace mocurate
