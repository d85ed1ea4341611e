#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "eval/dose/damages.h"

namespace mocurate {

inline constexpr const char* kUndamaged = "undamaged";  ///< name of the row of dose none

/// Name of a row: "jitter_mm=5"; kUndamaged for the dose without effect.
std::string DoseRowName(Damage damage, double dose);

/// Response of each metric to each damage, the content of dose_response.json: {"real": {METRIC: of real motions against
/// others}, "values": [{"damage", "unit", "dose", "undamaged": whether this dose has no effect, "metric", "value",
/// "low", "high", "ratio": to the undamaged motions, null where these have 0 or no value, "shift": from them, in half
/// widths of the wider of both intervals, "answers"}] by damage, dose (undamaged first) and metric, "answers_from":
/// {DAMAGE: {METRIC: the nearest doses on either side of the neutral one that the metric responds to}}}.
///
/// `rows` are those of an evaluation (as of ScoreRow) named by DoseRowName; missing ones are skipped. A metric responds
/// to a dose where its interval and that of the undamaged motions are disjoint; where one of them has no interval,
/// where its value differs from theirs by more than a tenth of it and by more than real motions differ (row "Real"); a
/// change below 1e-6 never counts, because rounding gives.
nlohmann::json DoseTable(const nlohmann::json& rows, const std::vector<DoseSeries>& series);

/// The smallest dose that each metric responds to, then a table for each damage, under `title`.
std::string DoseMarkdown(const nlohmann::json& table, const std::string& title);
/// "damage,unit,dose,metric,value,low,high,ratio,shift,answers", a line a value.
std::string DoseCsv(const nlohmann::json& table);

}  // namespace mocurate
