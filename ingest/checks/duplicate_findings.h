#pragma once

#include <string>

#include "core/base/finding.h"
#include "core/quality/duplicates.h"
#include "ingest/checks/check_options.h"

namespace mocurate {

DuplicateLimits DuplicateLimitsOf(const CheckOptions& options);

/// The finding of a pair of equal clips, about the second: "duplicate", "near_duplicate",
/// "mirrored_duplicate" or "shared_frames", the same for what is inspected and what is ingested. `first_name` names the
/// other one. The clip is left to the caller.
Finding DuplicateFinding(const Duplicate& pair, const std::string& first_name, const MotionSignature& first,
                         const MotionSignature& second);

}  // namespace mocurate
