#include "eval/dose/dose_table.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kLeastChange = 0.1;      // for a metric without an interval
constexpr double kStoredRounding = 1e-6;  // relative change by storing positions in float32

const nlohmann::json* RowNamed(const nlohmann::json& rows, const std::string& name) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const nlohmann::json& row) { return row.at("name") == name; });
  return found == rows.end() ? nullptr : &*found;
}

/// Value of a metric in a row; nothing without a number.
std::optional<DoseValue> ValueOfRow(const nlohmann::json& row, const std::string& metric) {
  const nlohmann::json found = row.at("metrics").value(metric, nlohmann::json());
  if (!found.is_object() || !found.at("value").is_number()) return std::nullopt;
  DoseValue value;
  value.metric = metric;
  value.value = found["value"].get<double>();
  if (found.at("interval").is_array()) value.interval = found["interval"].get<std::array<double, 2>>();
  return value;
}

double HalfWidth(const DoseValue& value) { return 0.5 * ((*value.interval)[1] - (*value.interval)[0]); }

void CompareWithUndamaged(const DoseValue& undamaged, std::optional<double> real, DoseValue& value) {
  if (undamaged.value != 0.0) value.ratio = value.value / undamaged.value;
  const double change = value.value - undamaged.value;
  if (std::abs(change) < kStoredRounding) return;
  if (value.interval && undamaged.interval) {
    const double half = std::max(HalfWidth(value), HalfWidth(undamaged));
    if (half > 0.0) value.shift = change / half;
    value.answers = (*value.interval)[0] > (*undamaged.interval)[1] || (*value.interval)[1] < (*undamaged.interval)[0];
    return;
  }
  const double noise = real ? std::abs(*real - undamaged.value) : 0.0;
  value.answers = std::abs(change) > std::max(kLeastChange * std::abs(undamaged.value), noise);
}

std::string DosesText(const std::vector<double>& doses) {
  std::string text;
  for (const double dose : doses) text += (text.empty() ? "" : ", ") + FormatDouble(dose);
  return text.empty() ? "–" : text;
}

std::vector<double> WithNone(const DoseSeries& series) {
  std::vector<double> doses = series.doses;
  doses.insert(doses.begin(), InfoOf(series.damage).none);
  return doses;
}

std::string OptionalText(const std::optional<double>& value) { return value ? FormatDouble(*value) : ""; }

nlohmann::json OptionalJson(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

std::string HeaderOf(const std::string& first, const std::vector<std::string>& metrics) {
  std::string names = "| " + first + " |", rule = "|---|";
  for (const std::string& metric : metrics) {
    names += " " + metric + " |";
    rule += "---|";
  }
  return names + "\n" + rule + "\n";
}

}  // namespace

std::string DoseRowName(Damage damage, double dose) {
  const DamageInfo& info = InfoOf(damage);
  return dose == info.none ? kUndamaged : std::string(info.name) + "=" + FormatDouble(dose);
}

const DoseValue* DoseTable::Find(Damage damage, double dose, const std::string& metric) const {
  const auto found = std::find_if(values.begin(), values.end(), [&](const DoseValue& one) {
    return one.damage == damage && one.dose == dose && one.metric == metric;
  });
  return found == values.end() ? nullptr : &*found;
}

std::vector<double> DoseTable::AnsweredFrom(Damage damage, const std::string& metric) const {
  const double none = InfoOf(damage).none;
  std::optional<double> below, above;
  for (const DoseValue& value : values) {
    if (value.damage != damage || value.metric != metric || !value.answers) continue;
    if (value.dose < none) below = below ? std::max(*below, value.dose) : value.dose;
    if (value.dose > none) above = above ? std::min(*above, value.dose) : value.dose;
  }
  std::vector<double> doses;
  for (const auto& one : {below, above}) {
    if (one) doses.push_back(*one);
  }
  return doses;
}

DoseTable MakeDoseTable(const nlohmann::json& rows, const std::vector<DoseSeries>& series) {
  DoseTable table;
  table.series = series;
  std::set<std::string> metrics;
  for (const nlohmann::json& row : rows) {
    for (const auto& [metric, value] : row.at("metrics").items()) {
      if (value.at("value").is_number()) metrics.insert(metric);
    }
  }
  table.metrics.assign(metrics.begin(), metrics.end());
  if (const nlohmann::json* real = RowNamed(rows, "Real")) {
    for (const std::string& metric : table.metrics) {
      if (const auto value = ValueOfRow(*real, metric)) table.real[metric] = value->value;
    }
  }
  const nlohmann::json* undamaged = RowNamed(rows, kUndamaged);
  for (const DoseSeries& one : series) {
    for (const double dose : WithNone(one)) {
      const nlohmann::json* row = RowNamed(rows, DoseRowName(one.damage, dose));
      if (row == nullptr) continue;
      for (const std::string& metric : table.metrics) {
        auto value = ValueOfRow(*row, metric);
        if (!value) continue;
        value->damage = one.damage;
        value->dose = dose;
        const auto before = undamaged == nullptr ? std::nullopt : ValueOfRow(*undamaged, metric);
        const auto real = table.real.find(metric);
        if (before && row != undamaged) {
          CompareWithUndamaged(*before, real == table.real.end() ? std::nullopt : std::optional(real->second), *value);
        }
        table.values.push_back(std::move(*value));
      }
    }
  }
  return table;
}

std::string DoseMarkdown(const DoseTable& table, const std::string& title) {
  std::string text = "# " + MarkdownText(title) +
                     "\n\nThe smallest dose that each metric responds to; –: to none of the doses.\n\n" +
                     HeaderOf("damage", table.metrics);
  for (const DoseSeries& series : table.series) {
    text += std::string("| ") + InfoOf(series.damage).name + " |";
    for (const std::string& metric : table.metrics) {
      text += " " + DosesText(table.AnsweredFrom(series.damage, metric)) + " |";
    }
    text += "\n";
  }
  text +=
      "\nA metric responds (*) where its interval and that of the undamaged motions are disjoint; without an "
      "interval,\n"
      "where it differs by more than a tenth, and by more than real motions differ from each other (row Real).\n";
  for (const DoseSeries& series : table.series) {
    const DamageInfo& info = InfoOf(series.damage);
    text += std::string("\n## ") + info.name + "\n\n" + info.help + ", " + info.unit + "\n\n" +
            HeaderOf(info.name, table.metrics);
    text += "| Real |";
    for (const std::string& metric : table.metrics) {
      const auto real = table.real.find(metric);
      text += " " + (real == table.real.end() ? "–" : RoundedText(real->second, 3)) + " |";
    }
    text += "\n";
    for (const double dose : WithNone(series)) {
      text += "| " + FormatDouble(dose) + " |";
      for (const std::string& metric : table.metrics) {
        const DoseValue* value = table.Find(series.damage, dose, metric);
        text += " " + (value == nullptr ? "–" : RoundedText(value->value, 3) + (value->answers ? " *" : "")) + " |";
      }
      text += "\n";
    }
  }
  return text;
}

std::string DoseCsv(const DoseTable& table) {
  std::string text = "damage,unit,dose,metric,value,low,high,ratio,shift,answers\n";
  for (const DoseValue& value : table.values) {
    const DamageInfo& info = InfoOf(value.damage);
    text += std::string(info.name) + "," + info.unit + "," + FormatDouble(value.dose) + "," + value.metric + "," +
            FormatDouble(value.value) + ",";
    text += value.interval ? FormatDouble((*value.interval)[0]) + "," + FormatDouble((*value.interval)[1]) : ",";
    text +=
        "," + OptionalText(value.ratio) + "," + OptionalText(value.shift) + "," + (value.answers ? "1" : "0") + "\n";
  }
  return text;
}

nlohmann::json DoseJson(const DoseTable& table) {
  nlohmann::json json = {
      {"real", table.real}, {"values", nlohmann::json::array()}, {"answers_from", nlohmann::json::object()}};
  for (const DoseValue& value : table.values) {
    const DamageInfo& info = InfoOf(value.damage);
    const auto end = [&](std::size_t i) {
      return value.interval ? nlohmann::json((*value.interval)[i]) : nlohmann::json();
    };
    json["values"].push_back({{"damage", info.name},
                              {"unit", info.unit},
                              {"dose", value.dose},
                              {"undamaged", value.dose == info.none},
                              {"metric", value.metric},
                              {"value", value.value},
                              {"low", end(0)},
                              {"high", end(1)},
                              {"ratio", OptionalJson(value.ratio)},
                              {"shift", OptionalJson(value.shift)},
                              {"answers", value.answers}});
  }
  for (const DoseSeries& series : table.series) {
    for (const std::string& metric : table.metrics) {
      json["answers_from"][InfoOf(series.damage).name][metric] = table.AnsweredFrom(series.damage, metric);
    }
  }
  return json;
}

}  // namespace mocurate
