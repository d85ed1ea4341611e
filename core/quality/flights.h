#pragma once

#include <vector>

#include "core/quality/body_path.h"

namespace mocurate {

/// A stretch in which the body falls freely: its centre of mass is on a parabola.
struct Flight {
  int frame_begin = 0;
  int frame_end = 0;
  double fall = 0.0;      ///< metres per frame^2 by which it falls: 9.81 m/s2 at the true rate
  double sag = 0.0;       ///< metres that the path bends over the flight
  double residual = 0.0;  ///< metres, root mean square, vertical
};

/// Flights: at least 5 frames with every sole 5 cm over its floor, a take-off and a landing that push the body upwards,
/// the centre of mass on a parabola (to 3 % of its sag, 2 cm at least) over a straight line (20 %), the trunk falling
/// as it does (20 %). None of that depends on the rate, which is what flights are asked for.
std::vector<Flight> FindFlights(const BodyPath& body);

}  // namespace mocurate
