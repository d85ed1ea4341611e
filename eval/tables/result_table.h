#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "eval/tables/table.h"

namespace mocurate {

/// Direction in which a metric is better; kNearReal: near that of real motions.
enum class Better { kLess, kMore, kNearReal, kNone };

/// Value of a row's "given" where each motion began with the first pose of a real one: not ranked.
inline constexpr const char* kGivenFirstPose = "first_pose";
/// The same of a yardstick, which is made of real motions.
inline constexpr const char* kGivenMotions = "motions";

/// A metric as a column of tables.
struct MetricColumn {
  const char* key;
  const char* title;  ///< with an arrow towards better values
  int digits;
  Better better;
  bool of_features;   ///< depends on a recogniser: numbers of two recognisers have no ratio
  bool shown = true;  ///< in tables; the others are in the JSON alone, because a table must fit a page
};

/// All metrics, in the order of columns.
const std::vector<MetricColumn>& MetricColumns();

/// {"value", "interval", "interval_kind", "repetitions"} as a cell; empty where there is no number.
Table::Cell CellOf(const nlohmann::json& metric);

/// The cell of a published number, an entry of PublishedOf.
Table::Cell PublishedCell(const nlohmann::json& published);

/// The table of an evaluation, {"rows": [as of ScoreRow], "published": [as of PublishedOf], "notes": [texts],
/// "original_data": bool}: our rows in their order, then the published ones by method. Columns are the metrics that a
/// row has. On the papers' original data our value is marked where it lies outside the published interval of the
/// method of that name.
Table ResultTable(const nlohmann::json& result, const std::string& title);

/// That table as NAME.md, .csv, .tex and .json ({"rows", "published", "notes"}) below `folder`. Returns the files.
/// Error kCannotWrite.
Expected<std::vector<std::filesystem::path>> WriteTables(const nlohmann::json& result, const Table& table,
                                                         const std::filesystem::path& folder,
                                                         const std::string& name = "table");

}  // namespace mocurate
