#pragma once

#include <vector>

#include "canon/options.h"
#include "core/motion/motion.h"

namespace mocurate {

/// One repetition of an exercise, frames [begin, end).
struct Repetition {
  int begin = 0;
  int end = 0;
  double confidence = 1.0;  ///< similarity to the adjacent repetitions, in [0, 1]
};

/// Cuts a recording of one exercise into its repetitions.
///
/// The moving part of the recording is compared with itself: d(lag) is the mean squared distance of the body's poses
/// and velocities at times `lag` apart, over the half of the times that agree best. A period is a lag where d falls to
/// at most half of the largest d of shorter lags (after Cutler and Davis 2000). Of several, the shortest that is nearly
/// as good as the best is used, so that two repetitions do not count as one. Dynamic programming then places boundaries
/// from the begin of the moving part to its end: repetitions about as long as the period, and similar to their
/// neighbours.
///
/// Repetitions in order, from the first moving frame to the last one; a single one for a motion that is not periodic
/// (confidence: the smallest ratio of d to the largest of shorter lags), none for one that never moves.
std::vector<Repetition> FindCycles(const CycleOptions& options, const Motion& motion);

}  // namespace mocurate
