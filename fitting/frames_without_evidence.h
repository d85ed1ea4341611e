#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"

namespace mocurate {

/// Code of the findings of frames in which no part of the person was observed.
inline constexpr const char* kFramesWithoutEvidence = "frames_without_evidence";

/// One finding per run of frames that are `without` (F): `what`, the number of frames and the replacement.
void ReportFramesWithout(const std::vector<bool>& without, const std::string& what, FindingAction action,
                         std::vector<Finding>& findings);

}  // namespace mocurate
