#pragma once

#include <vector>

#include "canon/options.h"
#include "core/motion/motion.h"

namespace mocurate {

/// A piece of a recording between two change points, frames [begin, end).
struct ProposedSegment {
  int begin = 0;
  int end = 0;
  bool rest = false;        ///< still, in the recording's most frequent still posture
  double confidence = 1.0;  ///< probability that `begin` is a boundary; 1 for the first segment
};

/// Cuts a recording where the action changes, into the pieces that minimise
///
///   sum over the segments of  sum_t |phi(x_t) - mean|^2 / rate  +  sum over the boundaries of  penalty(t)
///
/// by dynamic programming (kernel change-point detection: Harchaoui and Cappe 2007, Arlot et al. 2019). phi is the
/// feature map of a Gaussian kernel over the descriptions x_t at 25 Hz: the body's pose, the speed of each joint, and
/// the distance from rest. The penalty is small at rest, where actions begin and end, and larger within a movement.
/// Rest is stillness in the posture that most separate still moments share; a recording without such moments has a
/// constant penalty. A rest shorter than `least_rest_s` becomes one boundary in its middle.
///
/// Segments in order, from the first frame to the last; empty for a motion without frames. Boundaries below
/// `min_confidence` are dropped. Time is linear in the length: about 0.15 s for a minute at 120 Hz.
std::vector<ProposedSegment> ProposeSegments(const ChangePointOptions& options, const Motion& motion);

}  // namespace mocurate
