#pragma once

#include <optional>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// The error of a header whose count what follows contradicts, kInconsistent: "Frames announces 12, the file holds 10".
tl::unexpected<Error> CountContradiction(const std::string& count, double announced, double held,
                                         const std::string& where);

/// What such an error says was announced; nothing for any other.
std::optional<double> AnnouncedCount(const Error& error);

}  // namespace mocurate
