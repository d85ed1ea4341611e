#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/quality/tracked_points.h"

namespace mocurate {

/// One bound or estimate of the rate from mechanics and the human body.
struct RateClue {
  double lowest = 0.0;                                       ///< Hz
  double highest = std::numeric_limits<double>::infinity();  ///< Hz
  double rate_hz = 0.0;                                      ///< best estimate; 0: limits only
  double confidence = 0.0;
  std::string words;
};

/// Estimate of a motion's rate, independent of the speed at which a person chooses to move.
struct RateMeasure {
  std::vector<RateClue> clues;  ///< best first
  double lowest = 0.0;          ///< Hz that all clues allow
  double highest = std::numeric_limits<double>::infinity();

  bool IsConclusive() const { return !clues.empty() && lowest <= highest; }
  bool Allows(double rate_hz) const { return !IsConclusive() || (rate_hz >= lowest && rate_hz <= highest); }
  /// Best estimate within the limits of all clues; empty where there are limits only.
  std::optional<double> rate_hz() const;
  double confidence() const { return IsConclusive() ? clues[0].confidence : 0.0; }
  std::string Range() const;  ///< "85 to 160 Hz", "at most 160 Hz"
  std::string Words() const;  ///< of all clues
};

/// Four clues, with limits that correct takes keep by a margin (docs/real_sets.md has how often they apply):
/// flights (FindFlights: 9.81 m/s2 to -35 and +50 %, by two that agree or a high one), steps (MeasureStepPendulum: 9.81
/// m/s2 by a factor of 0.3 to 2.8, of 0.15 where a stance is of fewer than 8 frames), the fall of the centre of mass,
/// which falls at most at 1.7 g above the noise, and limbs, whose ends stay below 150 m/s2 for three quarters of the
/// time. The first two bound the rate on both sides, the others from above alone: people may move slowly. Metres, y up;
/// `body` of the points must name hips, knees, ankles and shoulders.
RateMeasure MeasureRate(const TrackedPoints& points);

/// "rate_suspect" where `rate_hz` lies outside of the limits of the motion; value: the best estimate or the nearest
/// rate within the limits. `points.time_s` must be of that rate.
std::vector<Finding> FindWrongRate(const TrackedPoints& points, double rate_hz);

}  // namespace mocurate
