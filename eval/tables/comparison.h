#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/tables/table.h"

namespace mocurate {

/// How our rows are set beside the published ones.
struct ComparisonOptions {
  std::string title;
  std::string profile;                              ///< stands behind the name of each of our rows; empty: nothing
  std::map<std::string, std::string> published_as;  ///< row -> method; "": it stands alone
};

/// A published table with our numbers beside it.
struct Comparison {
  Table table;          ///< three columns a metric: ours, published, ours divided by published with its interval
  nlohmann::json rows;  ///< [{"method", "published_as", "profile", "metrics": {M: {"value", "interval",
                        ///< "interval_kind", "published", "published_pm", "pm_kind", "ratio", "ratio_interval"}}}]
  /// [{"metric", "pairs", "as_published", "equal"}]: pairs of rows that are no real motions, how many of them stand in
  /// the published order, and in how many ours are equal; of metrics where less or more is better.
  nlohmann::json order = nlohmann::json::array();
};

/// {"rows", "published"} as of ResultTable; a row may say a "profile" of its own, and is then of no order. A row NAME
/// or NAME/SEED stands beside the method NAME; Real beside what the paper calls its real motions. Rows that nothing was
/// published of have ours alone, methods without a row of ours the published number alone; metrics that nothing was
/// published of are left out, unless nothing was published at all.
Comparison ComparePublished(const nlohmann::json& result, const ComparisonOptions& options);

/// The first line of ComparisonCsv.
std::string ComparisonCsvHead();
/// The rows of a comparison in long form: set, method, published_as, profile, metric, value, its interval and kind,
/// the published value with its +- and kind, ratio and its interval; a line a number.
std::string ComparisonCsv(const std::string& set, const Comparison& comparison);

}  // namespace mocurate
