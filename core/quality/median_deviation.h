#pragma once

namespace mocurate {

/// Standard deviation of normal errors over their median absolute deviation.
constexpr double kMadToSigma = 1.4826;

}  // namespace mocurate
