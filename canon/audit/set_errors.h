#pragma once

#include <vector>

#include "canon/audit/clip_errors.h"

namespace mocurate {

/// Errors of a dataset as a whole. "class_not_trained": a split tests a class that it does not train. "names_alike":
/// names of two persons that differ in case or blanks only; a split by person would separate them. "split_leak"
/// (error): a person, style or performance is in two parts of a split that keeps them apart by its rule, with a clip of
/// either part; a warning for all persons of a split whose rule is unknown. The others are without a clip.
std::vector<AuditFinding> FindSetErrors(const Dataset& dataset);

}  // namespace mocurate
