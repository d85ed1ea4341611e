#pragma once

#include <vector>

#include "canon/options.h"
#include "core/motion/motion.h"

namespace mocurate {

/// One repetition of an exercise, frames [begin, end).
struct Repetition {
  int begin = 0;
  int end = 0;
  double confidence = 1.0;  ///< similarity to the repetitions beside it, in [0, 1]
};

/// Cuts a recording of one exercise into its repetitions.
///
/// The moving part of the recording is compared with itself: d(lag) is the mean squared distance of the body's poses
/// and velocities at times `lag` apart, of the half of the times that agree best. A period is a lag at which d falls to
/// half and less of the largest d of shorter lags (after Cutler and Davis 2000); of several the shortest that is nearly
/// as good as the best, so that two repetitions are not taken for one. Dynamic programming then places boundaries from
/// the begin of the moving part to its end: repetitions about as long as the period, and alike where they meet.
///
/// Repetitions in order, from the first moving frame to the last one; one of a motion that does not repeat itself
/// (confidence: the least d of a lag over the largest of shorter ones), none of one that never moves.
std::vector<Repetition> FindCycles(const CycleOptions& options, const Motion& motion);

}  // namespace mocurate
