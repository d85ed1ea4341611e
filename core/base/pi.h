#pragma once

namespace mocurate {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegrees = 180.0 / kPi;  ///< of a radian

}  // namespace mocurate
