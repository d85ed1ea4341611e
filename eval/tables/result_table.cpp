#include "eval/tables/result_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "eval/metrics/interval.h"

namespace mocurate {
namespace {

/// Puts a published number into the cell of its row; adds the row where it is new.
void AddPublished(const nlohmann::json& value, const std::vector<const MetricColumn*>& columns,
                  std::vector<Table::Row>& rows) {
  const std::string method = value.at("method").get<std::string>(), source = value.at("source").get<std::string>();
  const auto column = std::find_if(columns.begin(), columns.end(),
                                   [&](const MetricColumn* one) { return value.at("metric") == one->key; });
  if (column == columns.end()) return;
  auto row = std::find_if(rows.begin(), rows.end(),
                          [&](const Table::Row& one) { return one.name == method && one.source == source; });
  if (row == rows.end()) row = rows.insert(rows.end(), {method, std::vector<Table::Cell>(columns.size()), source});
  row->cells[static_cast<std::size_t>(column - columns.begin())] = PublishedCell(value);
}

/// The interval of a published mean, widened by its rounding. ACTOR prints 1.96 times the variance of 20 repetitions
/// (a2m_actor.md F7).
std::array<double, 2> IntervalOf(const nlohmann::json& published) {
  constexpr double kRepetitions = 20.0, kNormal = 1.96;
  const double value = published.at("value").get<double>();
  const double pm = published.at("pm").get<double>() + published.value("pm_rounding", 0.0);
  const bool variance = published.at("pm_kind") == Name(IntervalKind::kActor);
  const double half =
      (variance ? kNormal * std::sqrt(pm / kNormal / kRepetitions) : pm) + published.value("rounding", 0.0);
  return {value - half, value + half};
}

/// Whether a published number matches the row: the same method by the same paper's protocol. The papers' names of real
/// motions are "Real motions", "Real", "Real*" and "Real-train"; "Real [A2M]" is quoted.
bool IsOfRow(const nlohmann::json& published, const nlohmann::json& row, const nlohmann::json& result) {
  if (published.at("paper") != result.value("paper", nlohmann::json())) return false;
  const std::string method = published.at("method").get<std::string>();
  if (method == row.at("name") || !row.value("real", false)) return method == row.at("name");
  if (row.at("name") != "Real") return false;
  return method == "Real motions" || method == "Real" || method == "Real*" || method == "Real-train";
}

/// Marks figures outside every published interval of their row.
void MarkRows(const nlohmann::json& result, const std::vector<const MetricColumn*>& columns,
              std::vector<Table::Row>& rows) {
  std::set<std::pair<std::size_t, std::size_t>> compared;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const nlohmann::json& published : result.value("published", nlohmann::json::array())) {
      if (!published.at("pm").is_number() || !IsOfRow(published, result.at("rows")[r], result)) continue;
      for (std::size_t c = 0; c < columns.size(); ++c) {
        Table::Cell& cell = rows[r].cells[c];
        if (published.at("metric") != columns[c]->key || !cell.value) continue;
        const auto [low, high] = IntervalOf(published);
        const bool outside = *cell.value < low || *cell.value > high;
        const bool first = compared.insert({r, c}).second;
        cell.marked = outside && (first || cell.marked);
      }
    }
  }
}

/// Assumptions about rows, as sentences: a code and its rows.
std::vector<std::string> AssumptionNotes(const nlohmann::json& result) {
  static const std::map<std::string, std::string> kTexts = {
      {"own_bones_without_smpl_files", "joints as given; the protocol scores SMPL's mean body"},
      {"same_motions_in_every_repetition", "every repetition scores the same motions, hidden states and crops differ"},
      {"labels_as_in_the_files", "labels as in the files; the protocol draws them"},
      {"real_in_two_halves", "one half of the clips against the other"},
      {"array_in_extractor_frame", "a plain array, read in the frame, unit, joints and rate of the extractor"}};
  std::map<std::string, std::string> rows;
  for (const nlohmann::json& row : result.at("rows")) {
    for (const std::string& code : row.value("assumed", std::vector<std::string>())) {
      rows[code] += (rows[code].empty() ? "" : ", ") + row.at("name").get<std::string>();
    }
  }
  std::vector<std::string> notes;
  for (const auto& [code, names] : rows) {
    const auto text = kTexts.find(code);
    notes.push_back(names + ": " + (text == kTexts.end() ? code : text->second) + ".");
  }
  return notes;
}

/// An entry of OrdersOfSeeds as a sentence.
std::string OrderNote(const nlohmann::json& order) {
  const auto& columns = MetricColumns();
  const auto column = std::find_if(columns.begin(), columns.end(),
                                   [&](const MetricColumn& one) { return order.at("metric") == one.key; });
  return std::string(column->title) + ": " + order.at("better").get<std::string>() + " before " +
         order.at("worse").get<std::string>() + ", " + order.at("seeds")[0].dump() + " and " +
         order.at("seeds")[1].dump() + " trainings, one-sided p " + RoundedText(order.at("p").get<double>(), 3) +
         ", for all pairs " + RoundedText(order.at("p_holm").get<double>(), 3) + " (Holm); the least possible is " +
         RoundedText(order.at("least_p").get<double>(), 3) + ".";
}

/// Beside what FID_equal is read: the real motions at the same number, and p.
std::vector<std::string> EqualSizeNotes(const nlohmann::json& result) {
  std::vector<std::pair<std::string, std::string>> read;  // what a row is read beside, and the rows
  for (const nlohmann::json& row : result.at("rows")) {
    const nlohmann::json fid = row.value("metrics", nlohmann::json::object()).value("FID_equal", nlohmann::json());
    if (row.value("real", false) || !fid.is_object() || !fid.at("value").is_number() || !fid.contains("real")) continue;
    const nlohmann::json p = fid.value("p", nlohmann::json());
    const std::string beside = fid.at("motions").dump() + " motions on both sides, of real motions " +
                               RoundedText(fid.at("real").get<double>(), 3) +
                               (p.is_number() ? "; differs with p " + RoundedText(p.get<double>(), 2) : "") + ".";
    const std::string name = row.at("name").get<std::string>();
    const auto same = std::find_if(read.begin(), read.end(), [&](const auto& one) { return one.first == beside; });
    if (same == read.end()) {
      read.emplace_back(beside, name);
    } else {
      same->second += ", " + name;
    }
  }
  std::vector<std::string> notes;
  for (const auto& [beside, rows] : read) {
    notes.push_back("FID, equal sizes" + (read.size() > 1 ? " of " + rows : std::string()) + ": " + beside);
  }
  return notes;
}

}  // namespace

const std::vector<MetricColumn>& MetricColumns() {
  static const std::vector<MetricColumn> kColumns = {
      {"FID_train", "FID train ↓", 3, Better::kLess, true},
      {"FID_test", "FID test ↓", 3, Better::kLess, true},
      {"FID_equal", "FID, equal sizes ↓", 3, Better::kLess, true},
      {"FID_inf", "FID, unbiased ↓", 3, Better::kLess, true},
      {"FID_normalised", "FID, normalised ↓", 4, Better::kLess, true, false},
      {"FID_train_published", "FID train, published recogniser ↓", 3, Better::kLess, true},
      {"accuracy_published", "Accuracy, published recogniser ↑", 3, Better::kMore, true},
      {"accuracy", "Accuracy ↑", 3, Better::kMore, true},
      {"accuracy_denoised", "Accuracy, denoised ↑", 3, Better::kMore, true},
      {"accuracy_top5", "Top-5 ↑", 3, Better::kMore, true},
      {"accuracy_equivalent", "Accuracy, equivalent labels ↑", 3, Better::kMore, true},
      {"accuracy_top5_equivalent", "Top-5, equivalent labels ↑", 3, Better::kMore, true},
      {"diversity", "Diversity →", 3, Better::kNearReal, true},
      {"multimodality", "Multimodality →", 3, Better::kNearReal, true},
      {"KID", "KID ↓", 4, Better::kLess, true},
      {"density", "Density →", 3, Better::kNearReal, true},
      {"coverage", "Coverage ↑", 3, Better::kMore, true},
      {"precision", "Precision ↑", 3, Better::kMore, true, false},
      {"recall", "Recall ↑", 3, Better::kMore, true, false},
      {"nearest_train", "Nearest in train →", 3, Better::kNearReal, true},
      {"APD", "APD →", 3, Better::kNearReal, true, false},
      {"ACPD", "ACPD →", 3, Better::kNearReal, true, false},
      {"movement_of_real", "Movement, of real →", 2, Better::kNearReal, false},
      {"peak_jerk", "Peak jerk, m/s³ →", 0, Better::kNearReal, false},
      {"jerk_area", "Jerk area, m/s² →", 1, Better::kNearReal, false},
      {"mbench_slide", "MBench slide, mm/frame ↓", 2, Better::kLess, false},
      {"mbench_float", "MBench float ↓", 3, Better::kLess, false},
      {"mbench_jitter", "MBench jitter, mm/frame² ↓", 2, Better::kLess, false},
      {"mbench_dynamic", "MBench dynamic, mm/frame →", 2, Better::kNearReal, false},
      {"mbench_penetration", "MBench penetration, mm ↓", 2, Better::kLess, false},
      {"movement", "Movement, m/s →", 3, Better::kNearReal, false, false},
      {"foot_skate", "Foot skate, m/s ↓", 3, Better::kLess, false},
      {"floor_penetration", "Below floor, m ↓", 4, Better::kLess, false},
      {"jerk", "Jerk, m/s³", 1, Better::kNone, false},
      {"bone_spread", "Bone spread, m ↓", 4, Better::kLess, false},
      {"limit_violations", "Beyond limits ↓", 4, Better::kLess, false},
      {"frozen_share", "Frozen ↓", 3, Better::kLess, false},
      {"parameters", "Parameters", 0, Better::kNone, false},
      {"clips", "Clips", 0, Better::kNone, false}};
  return kColumns;
}

Table::Cell PublishedCell(const nlohmann::json& published) {
  Table::Cell cell;
  cell.value = published.at("value").get<double>();
  if (!published.at("pm").is_number()) return cell;
  const double pm = published["pm"].get<double>();
  cell.interval = {*cell.value - pm, *cell.value + pm};
  cell.interval_kind = published.at("pm_kind").get<std::string>();
  return cell;
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

Table ResultTable(const nlohmann::json& result, const std::string& title) {
  Table table;
  table.title = title;
  std::vector<const MetricColumn*> columns;
  for (const MetricColumn& column : MetricColumns()) {
    const nlohmann::json& rows = result.at("rows");
    const bool any = std::any_of(rows.begin(), rows.end(), [&](const nlohmann::json& row) {
      return row.contains("metrics") && CellOf(row["metrics"].value(column.key, nlohmann::json())).value.has_value();
    });
    if (!any || !column.shown) continue;
    columns.push_back(&column);
    table.columns.emplace_back(column.title);
    table.digits.push_back(column.digits);
  }
  for (const nlohmann::json& row : result.at("rows")) {
    Table::Row ours{row.at("name").get<std::string>(),
                    {},
                    "",
                    row.contains("unconverged"),
                    row.value("given", "") == kGivenFirstPose};
    const nlohmann::json metrics = row.value("metrics", nlohmann::json::object());
    for (const MetricColumn* column : columns)
      ours.cells.push_back(CellOf(metrics.value(column->key, nlohmann::json())));
    table.rows.push_back(std::move(ours));
  }
  std::vector<Table::Row> published;
  for (const nlohmann::json& value : result.value("published", nlohmann::json::array())) {
    AddPublished(value, columns, published);
  }
  if (result.value("original_data", false)) MarkRows(result, columns, table.rows);
  table.rows.insert(table.rows.end(), published.begin(), published.end());
  table.notes = result.value("notes", std::vector<std::string>());
  for (const std::string& note : AssumptionNotes(result)) table.notes.push_back(note);
  for (const std::string& note : EqualSizeNotes(result)) table.notes.push_back(note);
  for (const nlohmann::json& order : result.value("orders", nlohmann::json::array())) {
    table.notes.push_back(OrderNote(order));
  }
  for (const nlohmann::json& row : result.at("rows")) {
    if (!row.contains("unconverged")) continue;
    table.notes.push_back(row.at("name").get<std::string>() + " ‡: " + row["unconverged"].get<std::string>() + ".");
  }
  return table;
}

Expected<std::vector<std::filesystem::path>> WriteTables(const nlohmann::json& result, const Table& table,
                                                         const std::filesystem::path& folder, const std::string& name) {
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  const nlohmann::json rows = {{"rows", result.at("rows")},
                               {"published", result.value("published", nlohmann::json::array())},
                               {"notes", table.notes}};
  std::vector<std::filesystem::path> written;
  const std::pair<const char*, std::string> files[] = {
      {".md", ToMarkdown(table)}, {".csv", ToCsv(table)}, {".tex", ToLatex(table)}, {".json", rows.dump(1) + "\n"}};
  for (const auto& [ending, text] : files) {
    const std::filesystem::path file = folder / (name + ending);
    if (Status done = WriteFile(file, text); !done) return Forward(done);
    written.push_back(file);
  }
  return written;
}

}  // namespace mocurate
