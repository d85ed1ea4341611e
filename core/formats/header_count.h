#pragma once

#include <optional>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// The error of a header whose count what follows contradicts, kInconsistent: "Frames announces 12, the file holds 10".
/// With `at_most`, `held` is what the bytes allow, not what was counted, and is said so.
tl::unexpected<Error> CountContradiction(const std::string& count, double announced, double held,
                                         const std::string& where, bool at_most = false);

/// What such an error says was announced; nothing for any other.
std::optional<double> AnnouncedCount(const Error& error);

}  // namespace mocurate
