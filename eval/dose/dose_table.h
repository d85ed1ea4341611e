#pragma once

#include <array>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/dose/damages.h"

namespace mocurate {

inline constexpr const char* kUndamaged = "undamaged";  ///< name of the row of dose none

/// Name of a row: "jitter_mm=5"; kUndamaged for the dose without effect.
std::string DoseRowName(Damage damage, double dose);

/// One metric at one dose.
struct DoseValue {
  Damage damage = Damage::kJitter;
  double dose = 0.0;
  std::string metric;
  double value = 0.0;
  std::optional<std::array<double, 2>> interval;
  std::optional<double> ratio;  ///< to the undamaged motions; nothing where these have 0 or no value
  std::optional<double> shift;  ///< from the undamaged motions, in half widths of the wider of both intervals
  bool answers = false;         ///< see MakeDoseTable
};

/// Response of each metric to each damage.
struct DoseTable {
  std::vector<std::string> metrics;    ///< that have a value in any row, by name
  std::map<std::string, double> real;  ///< metric -> of real motions against others (row "Real")
  std::vector<DoseSeries> series;      ///< what was scored
  std::vector<DoseValue> values;       ///< by damage, dose (undamaged first) and metric
  const DoseValue* Find(Damage damage, double dose, const std::string& metric) const;
  /// The nearest doses on either side of the neutral one that the metric responds to, ascending; at most two.
  std::vector<double> AnsweredFrom(Damage damage, const std::string& metric) const;
};

/// From rows of an evaluation (as of ScoreRow) named by DoseRowName. A metric responds to a dose where its interval and
/// that of the undamaged motions are disjoint; where one of them has no interval, where its value differs from theirs
/// by more than a tenth of it and by more than real motions differ (row "Real"); a change below 1e-6 never counts,
/// because rounding gives. Missing rows are skipped.
DoseTable MakeDoseTable(const nlohmann::json& rows, const std::vector<DoseSeries>& series);

/// The smallest dose that each metric responds to, then a table for each damage, under `title`.
std::string DoseMarkdown(const DoseTable& table, const std::string& title);
/// "damage,unit,dose,metric,value,low,high,ratio,shift,answers", a line a value.
std::string DoseCsv(const DoseTable& table);
/// {"real": {METRIC: value}, "values": [the columns of the CSV, "undamaged"], "answers_from": {DAMAGE: {METRIC:
/// [doses]}}}.
nlohmann::json DoseJson(const DoseTable& table);

}  // namespace mocurate
