#include "eval/dose/dose_table.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr double kLeastChange = 0.1;      // for a metric without an interval
constexpr double kStoredRounding = 1e-6;  // relative change by storing positions in float32

struct DoseValue {
  double value = 0.0;
  std::optional<std::array<double, 2>> interval{};

  double HalfWidth() const { return 0.5 * ((*interval)[1] - (*interval)[0]); }
};

const Json* RowNamed(const Json& rows, const std::string& name) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Json& row) { return row.at("name") == name; });
  return found == rows.end() ? nullptr : &*found;
}

/// Value of a metric in a row; nothing without a row or a number.
std::optional<DoseValue> ValueOf(const Json* row, const std::string& metric) {
  const Json found = row == nullptr ? Json() : row->at("metrics").value(metric, Json());
  if (!found.is_object() || !found.at("value").is_number()) return std::nullopt;
  DoseValue value{found["value"].get<double>()};
  if (found.at("interval").is_array()) value.interval = found["interval"].get<std::array<double, 2>>();
  return value;
}

/// Sets "ratio", "shift" and "answers".
void CompareWithUndamaged(const DoseValue& undamaged, const std::optional<DoseValue>& real, const DoseValue& value,
                          Json& json) {
  if (undamaged.value != 0.0) json["ratio"] = value.value / undamaged.value;
  const double change = value.value - undamaged.value;
  if (std::abs(change) < kStoredRounding) return;
  if (value.interval && undamaged.interval) {
    const double half = std::max(value.HalfWidth(), undamaged.HalfWidth());
    if (half > 0.0) json["shift"] = change / half;
    json["answers"] =
        (*value.interval)[0] > (*undamaged.interval)[1] || (*value.interval)[1] < (*undamaged.interval)[0];
    return;
  }
  const double noise = real ? std::abs(real->value - undamaged.value) : 0.0;
  json["answers"] = std::abs(change) > std::max(kLeastChange * std::abs(undamaged.value), noise);
}

std::vector<double> AnsweredFrom(const Json& values, const DamageInfo& info, const std::string& metric) {
  std::optional<double> below, above;
  for (const Json& value : values) {
    if (value["damage"] != info.name || value["metric"] != metric || value["answers"] == false) continue;
    const double dose = value["dose"].get<double>();
    if (dose < info.none) below = std::max(dose, below.value_or(dose));
    if (dose > info.none) above = std::min(dose, above.value_or(dose));
  }
  std::vector<double> doses;
  for (const auto& one : {below, above}) {
    if (one) doses.push_back(*one);
  }
  return doses;
}

std::string CellOf(const Json& value) { return value.is_null() ? "" : FormatDouble(value.get<double>()); }

std::string MarkdownLine(const std::string& first, const std::vector<std::string>& cells) {
  return "| " + first + " | " + JoinTexts(cells, " | ") + " |\n";
}

}  // namespace

std::string DoseRowName(Damage damage, double dose) {
  const DamageInfo& info = InfoOf(damage);
  return dose == info.none ? kUndamaged : std::string(info.name) + "=" + FormatDouble(dose);
}

Json DoseTable(const Json& rows, const std::vector<DoseSeries>& series) {
  Json table = {{"real", Json::object()}, {"values", Json::array()}, {"answers_from", Json::object()}};
  std::set<std::string> metrics;
  for (const Json& row : rows) {
    for (const auto& [metric, value] : row.at("metrics").items()) {
      if (value.at("value").is_number()) metrics.insert(metric);
    }
  }
  const Json *real = RowNamed(rows, "Real"), *undamaged = RowNamed(rows, kUndamaged);
  for (const std::string& metric : metrics) {
    if (const auto value = ValueOf(real, metric)) table["real"][metric] = value->value;
  }
  for (const DoseSeries& one : series) {
    const DamageInfo& info = InfoOf(one.damage);
    std::vector<double> doses = one.doses;
    doses.insert(doses.begin(), info.none);
    for (const double dose : doses) {
      const Json* row = RowNamed(rows, DoseRowName(one.damage, dose));
      for (const std::string& metric : metrics) {
        const auto value = ValueOf(row, metric);
        if (!value) continue;
        const auto end = [&](std::size_t i) { return value->interval ? Json((*value->interval)[i]) : Json(); };
        Json json = {
            {"damage", info.name}, {"unit", info.unit},     {"dose", dose},    {"undamaged", dose == info.none},
            {"metric", metric},    {"value", value->value}, {"low", end(0)},   {"high", end(1)},
            {"ratio", nullptr},    {"shift", nullptr},      {"answers", false}};
        const auto before = ValueOf(undamaged, metric);
        if (before && row != undamaged) CompareWithUndamaged(*before, ValueOf(real, metric), *value, json);
        table["values"].push_back(std::move(json));
      }
    }
    for (const std::string& metric : metrics) {
      table["answers_from"][info.name][metric] = AnsweredFrom(table["values"], info, metric);
    }
  }
  return table;
}

std::string DoseMarkdown(const Json& table, const std::string& title) {
  std::vector<std::string> metrics, real, rules;
  const Json none = Json::object(), &answers = table.at("answers_from");
  for (const auto& [metric, doses] : (answers.empty() ? none : answers.front()).items()) {
    metrics.push_back(metric);
    real.push_back(table.at("real").contains(metric) ? RoundedText(table.at("real").at(metric), 3) : "–");
    rules.emplace_back("---");
  }
  std::string smallest = MarkdownLine("damage", metrics) + MarkdownLine("---", rules), values;
  const Json& all = table.at("values");
  for (auto value = all.begin(); value != all.end();) {  // a damage
    const std::string damage = value->at("damage").get<std::string>();
    std::vector<std::string> cells;
    for (const std::string& metric : metrics) {
      std::string doses;
      for (const double dose : answers.at(damage).at(metric)) doses += (doses.empty() ? "" : ", ") + FormatDouble(dose);
      cells.push_back(doses.empty() ? "–" : doses);
    }
    smallest += MarkdownLine(damage, cells);
    const auto info =
        std::find_if(Damages().begin(), Damages().end(), [&](const DamageInfo& one) { return one.name == damage; });
    values += "\n## " + damage + "\n\n" + info->help + ", " + info->unit + "\n\n" + MarkdownLine(damage, metrics) +
              MarkdownLine("---", rules) + MarkdownLine("Real", real);
    while (value != all.end() && value->at("damage") == damage) {  // a dose
      const double dose = value->at("dose").get<double>();
      cells.assign(metrics.size(), "–");
      for (; value != all.end() && value->at("damage") == damage && value->at("dose") == dose; ++value) {
        const auto place = std::find(metrics.begin(), metrics.end(), value->at("metric")) - metrics.begin();
        cells[static_cast<std::size_t>(place)] =
            RoundedText(value->at("value"), 3) + (value->at("answers") == true ? " *" : "");
      }
      values += MarkdownLine(FormatDouble(dose), cells);
    }
  }
  return "# " + MarkdownText(title) +
         "\n\nThe smallest dose that each metric responds to; –: to none of the doses.\n\n" + smallest +
         "\nA metric responds (*) where its interval and that of the undamaged motions are disjoint; without an "
         "interval,\nwhere it differs by more than a tenth, and by more than real motions differ from each other (row "
         "Real).\n" +
         values;
}

std::string DoseCsv(const Json& table) {
  std::string text = "damage,unit,dose,metric,value,low,high,ratio,shift,answers\n";
  for (const Json& value : table.at("values")) {
    const auto word = [&](const char* key) { return value.at(key).get<std::string>(); };
    text += word("damage") + "," + word("unit") + "," + CellOf(value.at("dose")) + "," + word("metric");
    for (const char* key : {"value", "low", "high", "ratio", "shift"}) text += "," + CellOf(value.at(key));
    text += value.at("answers") == true ? ",1\n" : ",0\n";
  }
  return text;
}

}  // namespace mocurate
