#pragma once

#include "core/quality/repeats.h"
#include "core/quality/rigidity.h"
#include "core/quality/swaps.h"
#include "core/quality/teleports.h"

namespace mocurate {

struct CheckLimits {
  RepeatLimits repeats;
  TeleportLimits teleports;
  SwapLimits swaps;
  RigidityLimits rigidity;
  bool metres = true;      ///< false: the unit is in doubt, and what is measured in metres (all but zeros, repeats,
                           ///< proportions and flatness) is not asked
  int most_per_code = 20;  ///< findings of one code; the rest is told in one more, with their number
};

/// What is wrong with one person's points: FindBlanks, FindRepeats, FindRepeatedStretches, FindTeleports, FindSwaps,
/// FindNoBody, FindFlat and FindWrongRate, in order of code, frame and joint. Metres, y up. What is blank is missing to
/// the others; numbers that are no body are told so and not asked for more. `rate_hz` 0: nobody says it, and it is not
/// doubted.
std::vector<Finding> CheckPoints(const TrackedPoints& points, double rate_hz, const CheckLimits& limits = {});

/// Share of the frames that findings of `code` cover.
double CoveredShare(const std::vector<Finding>& findings, const std::string& code, int frames);

}  // namespace mocurate
