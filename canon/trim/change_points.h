#pragma once

#include <vector>

#include "canon/options.h"
#include "core/motion/motion.h"

namespace mocurate {

/// A piece of a recording between two change points, frames [begin, end).
struct ProposedSegment {
  int begin = 0;
  int end = 0;
  bool rest = false;        ///< still, in the posture to which the recording returns most
  double confidence = 1.0;  ///< that `begin` is a boundary, in [0, 1]; 1 of the first segment
};

/// Cuts a recording where what is done changes. The pieces are those that minimise
///
///   sum over the segments of  sum_t |phi(x_t) - mean|^2 / rate  +  sum over the boundaries of  penalty(t)
///
/// by dynamic programming (kernel change-point detection: Harchaoui and Cappe 2007, Arlot et al. 2019), phi the feature
/// map of a Gaussian kernel over the descriptions x_t at 25 Hz: the body's pose, how fast each joint moves, and how
/// near it is to rest. The penalty is small where the body is at rest, for actions begin and end there, and larger
/// where it is in the middle of something. Rest is stillness in the posture that most separate moments of stillness
/// share; a recording without such moments has one penalty throughout. A rest shorter than `least_rest_s` is no segment
/// but one boundary in its middle.
///
/// Segments in order, from the first frame to the last; none of a motion without frames. Boundaries below
/// `min_confidence` are none. Time is linear in the length: about 0.15 s for a minute at 120 Hz.
std::vector<ProposedSegment> ProposeSegments(const ChangePointOptions& options, const Motion& motion);

}  // namespace mocurate
