#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

/// The published numbers of a data set in a text like configs/published/tables.csv, those of `paper` first, in our
/// metrics' names and units (accuracy as a fraction): [{"method", "paper", "dataset", "metric", "value", "pm",
/// "pm_kind" (a Name(IntervalKind)), "table", "source", "rounding" (half a unit of the value's last printed digit),
/// "pm_rounding"}]. Error kMalformed "name:line".
Expected<nlohmann::json> PublishedOf(std::string_view csv, const std::string& name, const std::string& paper,
                                     const std::string& dataset);

/// Of a list as of PublishedOf: those of a table of transitions under the metrics' plain names (FID_train_transition ->
/// FID_train), or all others.
nlohmann::json OfTransitions(const nlohmann::json& published, bool transitions);

}  // namespace mocurate
