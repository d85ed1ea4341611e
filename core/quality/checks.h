#pragma once

#include "core/quality/position_jumps.h"
#include "core/quality/repeats.h"
#include "core/quality/rigidity.h"
#include "core/quality/swaps.h"

namespace mocurate {

struct CheckLimits {
  RepeatLimits repeats;
  PositionJumpLimits position_jumps;
  SwapLimits swaps;
  RigidityLimits rigidity;
  bool metres = true;      ///< false: the unit is suspect, and checks in metres (all but zeros, repeats
                           ///< and proportions) are skipped
  int most_per_code = 20;  ///< findings of one code; one more finding gives the number of the rest
};

/// Defects of one person's points: FindBlanks, FindRepeats, FindPositionJumps, FindSwaps, FindNonRigidBody and
/// FindWrongRate, in order of code, frame and joint. Metres, y up. Blank samples are missing for the other checks; a
/// clip that is not a body gets no further checks. `rate_hz` 0: unknown, and not checked.
std::vector<Finding> CheckPoints(const TrackedPoints& points, double rate_hz, const CheckLimits& limits = {});

/// Share of the frames that findings of `code` cover.
double CoveredShare(const std::vector<Finding>& findings, const std::string& code, int frames);

}  // namespace mocurate
