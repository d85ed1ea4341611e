#pragma once

namespace mocurate {

/// Beyond any coordinate, angle, time or count of a person, in whatever unit; products of a few such are still finite.
inline constexpr double kLargestNumber = 1e30;

}  // namespace mocurate
