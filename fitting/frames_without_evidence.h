#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"

namespace mocurate {

/// Code of the findings of frames in which nothing was seen of the person.
inline constexpr const char* kFramesWithoutEvidence = "frames_without_evidence";

/// One finding per run of frames that are `without` (F): `what` and how many frames, and what was done instead.
void ReportFramesWithout(const std::vector<bool>& without, const std::string& what, FindingAction action,
                         std::vector<Finding>& findings);

}  // namespace mocurate
