#pragma once

namespace mocurate {

/// Beyond any coordinate, angle, time or count of a person, in whatever unit; products of a few such are still finite.
inline constexpr double kLargestNumber = 1e30;

/// Beyond any coordinate of a scan: a person in nanometres is 2e9 tall, and in millimetres stands 1e10 from the middle
/// of the earth.
inline constexpr double kLargestCoordinate = 1e12;
inline constexpr const char* kCoordinateHint =
    "coordinates reach to 1e12 in any unit: correct or leave out the point, or export the file again";

}  // namespace mocurate
