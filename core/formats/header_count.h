#pragma once

#include <string>

#include "core/base/error.h"

namespace mocurate {

/// The error of a header count that differs from the data, kInconsistent with Reason::kCount: "Frames announces 12,
/// the file holds 10". With `at_most`, `found` is what the bytes allow, not what was counted; the message states it.
tl::unexpected<Error> CountContradiction(const std::string& count, double announced, double found,
                                         const std::string& where, bool at_most = false);
}  // namespace mocurate
