#pragma once

#include <string>

#include "core/base/error.h"

namespace mocurate {

/// The error of a header whose count what follows contradicts, kInconsistent with Reason::kCount: "Frames announces 12,
/// the file holds 10". With `at_most`, `held` is what the bytes allow, not what was counted, and is said so.
tl::unexpected<Error> CountContradiction(const std::string& count, double announced, double held,
                                         const std::string& where, bool at_most = false);
}  // namespace mocurate
