#include "eval/tables/result_table.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"

namespace mocurate {
namespace {

struct MetricColumn {
  const char* key;
  const char* title;
  int digits;
};

constexpr MetricColumn kMetricColumns[] = {{"FID_train", "FID train ↓", 3},
                                           {"FID_test", "FID test ↓", 3},
                                           {"accuracy", "Accuracy ↑", 3},
                                           {"accuracy_top5", "Top-5 ↑", 3},
                                           {"accuracy_equivalent", "Accuracy, equivalent labels ↑", 3},
                                           {"diversity", "Diversity →", 3},
                                           {"multimodality", "Multimodality →", 3},
                                           {"KID", "KID ↓", 4},
                                           {"density", "Density →", 3},
                                           {"coverage", "Coverage ↑", 3},
                                           {"nearest_train", "Nearest in train →", 3},
                                           {"foot_skate", "Foot skate, m/s ↓", 3},
                                           {"floor_penetration", "Below floor, m ↓", 4},
                                           {"jerk", "Jerk, m/s³", 1},
                                           {"bone_spread", "Bone spread, m ↓", 4},
                                           {"limit_violations", "Beyond limits ↓", 4},
                                           {"frozen_share", "Frozen ↓", 3}};

Table::Cell CellOf(const nlohmann::json& metric) {
  Table::Cell cell;
  if (!metric.is_object() || !metric.at("value").is_number()) return cell;
  cell.value = metric["value"].get<double>();
  if (metric.at("interval").is_array()) {
    cell.interval = metric["interval"].get<std::array<double, 2>>();
    cell.interval_kind = metric.value("interval_kind", std::string());
  }
  cell.repetitions = metric.value("repetitions", std::vector<double>());
  return cell;
}

/// A published number as a cell of the row it belongs to; rows are made as they come.
void AddPublished(const nlohmann::json& value, const std::vector<const MetricColumn*>& columns,
                  std::vector<Table::Row>& rows) {
  const std::string method = value.at("method").get<std::string>(), source = value.at("source").get<std::string>();
  const auto column = std::find_if(columns.begin(), columns.end(),
                                   [&](const MetricColumn* one) { return value.at("metric") == one->key; });
  if (column == columns.end()) return;
  auto row = std::find_if(rows.begin(), rows.end(),
                          [&](const Table::Row& one) { return one.name == method && one.source == source; });
  if (row == rows.end()) row = rows.insert(rows.end(), {method, std::vector<Table::Cell>(columns.size()), source});
  Table::Cell& cell = row->cells[static_cast<std::size_t>(column - columns.begin())];
  cell.value = value.at("value").get<double>();
  if (!value.at("pm").is_number()) return;
  const double pm = value["pm"].get<double>();
  cell.interval = {*cell.value - pm, *cell.value + pm};
  cell.interval_kind = value.at("pm_kind").get<std::string>();
}

}  // namespace

Table ResultTable(const nlohmann::json& result, const std::string& title) {
  Table table;
  table.title = title;
  std::vector<const MetricColumn*> columns;
  for (const MetricColumn& column : kMetricColumns) {
    const nlohmann::json& rows = result.at("rows");
    const bool any = std::any_of(rows.begin(), rows.end(), [&](const nlohmann::json& row) {
      return row.contains("metrics") && CellOf(row["metrics"].value(column.key, nlohmann::json())).value.has_value();
    });
    if (!any) continue;
    columns.push_back(&column);
    table.columns.emplace_back(column.title);
    table.digits.push_back(column.digits);
  }
  for (const nlohmann::json& row : result.at("rows")) {
    Table::Row ours{row.at("name").get<std::string>(), {}, ""};
    const nlohmann::json metrics = row.value("metrics", nlohmann::json::object());
    for (const MetricColumn* column : columns)
      ours.cells.push_back(CellOf(metrics.value(column->key, nlohmann::json())));
    table.rows.push_back(std::move(ours));
  }
  std::vector<Table::Row> published;
  for (const nlohmann::json& value : result.value("published", nlohmann::json::array())) {
    AddPublished(value, columns, published);
  }
  if (result.value("original_data", false)) {
    for (Table::Row& ours : table.rows) {
      const auto same = std::find_if(published.begin(), published.end(),
                                     [&](const Table::Row& row) { return row.name == ours.name; });
      for (std::size_t c = 0; same != published.end() && c < columns.size(); ++c) {
        const auto& interval = same->cells[c].interval;
        const auto& value = ours.cells[c].value;
        ours.cells[c].marked = interval && value && (*value < (*interval)[0] || *value > (*interval)[1]);
      }
    }
  }
  table.rows.insert(table.rows.end(), published.begin(), published.end());
  table.notes = result.value("notes", std::vector<std::string>());
  return table;
}

Expected<WrittenTables> WriteTables(const nlohmann::json& result, const std::string& title,
                                    const std::filesystem::path& folder) {
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  const Table table = ResultTable(result, title);
  const nlohmann::json rows = {{"rows", result.at("rows")},
                               {"published", result.value("published", nlohmann::json::array())},
                               {"notes", table.notes}};
  WrittenTables written;
  written.markdown = ToMarkdown(table);
  const std::pair<const char*, std::string> files[] = {{"table.md", written.markdown},
                                                       {"table.csv", ToCsv(table)},
                                                       {"table.tex", ToLatex(table)},
                                                       {"table.json", rows.dump(1) + "\n"}};
  for (const auto& [name, text] : files) {
    if (Status done = WriteFile(folder / name, text); !done) return Forward(done);
    written.files.push_back(folder / name);
  }
  return written;
}

}  // namespace mocurate
