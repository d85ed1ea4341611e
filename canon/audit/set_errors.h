#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "canon/audit/clip_errors.h"

namespace mocurate {

/// Errors of a dataset as a whole; findings without a clip. "class_not_trained": a split tests a class that it does not
/// train. "names_alike": names of two persons that differ in case or blanks only; a split by person would separate
/// them.
std::vector<AuditFinding> FindSetErrors(const Dataset& dataset);

/// Coverage of the classes: {"persons_of_class": {class: count}, "seconds_of_class": {class: {least, median, most}},
/// "imbalance": clips of the largest class divided by those of the smallest non-empty one, "empty_classes": [...]}.
nlohmann::json CoverageOf(const Dataset& dataset);

}  // namespace mocurate
