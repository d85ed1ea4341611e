#pragma once

namespace mocurate {

/// Beyond any coordinate, angle, time or count of a person, in any unit; products of a few of them are still finite.
inline constexpr double kLargestNumber = 1e30;

/// Beyond any coordinate of a scan: a person in nanometres is 2e9 tall, and in millimetres 1e10 from the earth's
/// centre.
inline constexpr double kLargestCoordinate = 1e12;
inline constexpr const char* kCoordinateHint =
    "coordinates reach to 1e12 in any unit: correct or remove the point, or export the file again";

}  // namespace mocurate
