#pragma once

#include <optional>

#include "core/quality/tracked_points.h"

namespace mocurate {

/// A stretch in which the body falls freely: its middle is on a parabola.
struct Flight {
  int frame_begin = 0;
  int frame_end = 0;
  double gravity = 0.0;   ///< m/s2 that the parabola shows
  double sag = 0.0;       ///< metres that the path bends over the flight
  double residual = 0.0;  ///< metres, root mean square, vertical
};

/// What falling bodies say about the frame rate. Who jumps or runs falls with 9.81 m/s2; times that are wrong by a
/// factor n show it n^2 times as strong: a take of 60 frames a second marked 120 falls with 39 m/s2.
struct RateEvidence {
  std::vector<Flight> flights;
  double gravity = 0.0;  ///< median over the flights
  /// True rate over the stated one, to be told only where it is doubtful: the flights agree and lie outside what slow
  /// bodies and noise explain (0.75 to 1.33).
  std::optional<double> rate_factor;
};

/// Metres, y up. Flights are stretches of at least 4 frames and 0.08 s with both feet off the floor (5 cm over their
/// lowest 5 %) in which the mean of all points follows a parabola to 4 mm, and the horizontal path a line to 10 mm;
/// all points must be seen. Without feet, by name, and without flights, nothing is said; one flight tells only when it
/// is high (8 cm).
RateEvidence MeasureFlights(const TrackedPoints& points);

/// "rate_doubtful", with the number of frames a second that gravity asks for in `value`.
std::vector<Finding> FindWrongRate(const TrackedPoints& points, double rate_hz);

}  // namespace mocurate
