#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/quality/tracked_points.h"

namespace mocurate {

/// The rates that a motion allows, independent of the speed at which a person chooses to move.
struct RateLimits {
  double lowest = 0.0;  ///< Hz
  double highest = std::numeric_limits<double>::infinity();
  std::string evidence;  ///< empty: the motion shows no limit

  bool IsConclusive() const { return !evidence.empty() && lowest <= highest; }
  bool Allows(double rate_hz) const { return !IsConclusive() || (rate_hz >= lowest && rate_hz <= highest); }
  std::string Range() const;  ///< "85 to 160 Hz", "at most 160 Hz"
};

/// Limits that correct takes keep by a margin (docs/real_sets.md has how often they reject a wrong rate). Steps: over
/// one foot the body tips like an inverted pendulum, with 9.81 m/s2 by a factor of 0.3 to 2.8, of 0.15 where a stance
/// is of fewer than 8 frames. Falls: the centre of mass falls at most at 1.7 g above the noise. Limbs: their ends stay
/// below 150 m/s2 for three quarters of the time. Steps limit the rate on both sides, the others from above alone:
/// people may move slowly. Metres, y up; `body` of the points must name hips, knees, ankles and shoulders.
RateLimits MeasureRate(const TrackedPoints& points);

/// "rate_suspect" where `rate_hz` lies outside of the limits of the motion; value: the nearest rate within them.
/// `points.time_s` must be of that rate.
std::vector<Finding> FindWrongRate(const TrackedPoints& points, double rate_hz);

}  // namespace mocurate
