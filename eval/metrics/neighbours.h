#pragma once

#include "eval/metrics/feature_distances.h"

namespace mocurate {

/// Nearest-neighbour metrics of features.
struct NeighbourFigures {
  /// Mean over the motions of the number of reference balls that contain them, divided by k: about 1 for motions like
  /// the reference.
  double density = 0.0;
  double coverage = 0.0;  ///< share of the reference's balls that contain a motion
  /// Mean distance of the motions to their nearest in the reference, divided by that of the reference's motions to
  /// their nearest other: about 1 for new motions, near 0 for copies of the reference.
  double nearest = 0.0;
};

/// A ball reaches from each motion of the reference to its k-th nearest other. [Naeem et al. 2020, equations 3 and 4, k
/// = 5] Error kInconsistent where the reference has no k others or features differ in number.
Expected<NeighbourFigures> CompareNeighbours(const Features& motions, const Features& reference, int k = 5);

}  // namespace mocurate
