#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "canon/audit/clip_errors.h"

namespace mocurate {

/// What is wrong with a dataset as a whole; findings without a clip. "class_not_trained": a split tests a class that it
/// does not train. "names_alike": two persons whose names differ in case or in blanks only, who would be split apart.
std::vector<AuditFinding> FindSetErrors(const Dataset& dataset);

/// How the classes are covered: {"persons_of_class": {class: count}, "seconds_of_class": {class: {least, median,
/// most}}, "imbalance": clips of the largest class by those of the smallest that has any, "empty_classes": [...]}.
nlohmann::json CoverageOf(const Dataset& dataset);

}  // namespace mocurate
