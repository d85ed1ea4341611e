#pragma once

#include <optional>
#include <string>

#include "core/base/finding.h"

namespace mocurate {

/// How a file says its rate.
enum class RateUnit { kFramesPerSecond, kSecondsPerFrame };

/// Motion is recorded between these rates; faster cameras look at a hand or a foot alone.
inline constexpr double kSlowestRecorded_hz = 1.0, kFastestRecorded_hz = 2000.0;

/// The rate at which cameras and trackers run that is within half a per cent; nothing where none is.
std::optional<double> NearestUsualRate(double hz);

/// "rate_implausible", an error whose value is the rate: a rate of no recording, 1 Hz and less or more than
/// 2000. The message says as what the number of the file would be a usual rate: the other of both words, or
/// milliseconds. `place`: file and line or field. Nothing of a rate that the source declares.
std::optional<Finding> CheckStatedRate(double hz, RateUnit word, const std::string& place);

}  // namespace mocurate
