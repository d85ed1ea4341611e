#pragma once

#include <utility>
#include <vector>

#include "core/base/random.h"
#include "eval/metrics/fid.h"

namespace mocurate {

/// Pairs of motions for a metric's distances; drawn separately from the metric, so that a reference's draws can be
/// replayed.
using IndexPairs = std::vector<std::pair<int, int>>;

/// Diversity's pairs: both ends uniform with replacement, i = j possible. [a2m_actor.md D.5]
IndexPairs DrawDiversityPairs(int motions, int pairs, Random& random);

/// Multimodality's pairs: `quota` for each class that has motions, both ends uniform within the class, with
/// replacement. A class without motions has no pairs. Motions without a class (-1) are ignored.
IndexPairs DrawMultimodalityPairs(const std::vector<int>& labels, int classes, int quota, Random& random);

/// Mean Euclidean distance over the pairs; 0 without pairs.
double MeanDistance(const Features& features, const IndexPairs& pairs);

}  // namespace mocurate
