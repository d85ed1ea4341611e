#pragma once

namespace mocurate {

/// Range of the frame rates of motions and datasets: of ingest.source.rate, of /clips/rate. Work over time takes
/// samples at a rate of its own, so that a clip of a few frames over years has more of them than fit in memory.
inline constexpr double kSlowestRate_hz = 1e-3;
inline constexpr double kFastestRate_hz = 1e5;

}  // namespace mocurate
