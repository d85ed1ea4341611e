#pragma once

#include "core/store/store.h"

namespace mocurate {

/// Nearest-neighbour recognition without training, a baseline for every recogniser: joints relative to the root of
/// frame 0, divided by the clip's extent, resampled linearly to 32 frames, Euclidean distance. Each test clip
/// gets the label of the nearest training clip.
struct NearestNeighbourResult {
  int correct = 0;
  int count = 0;
  double accuracy() const { return count == 0 ? 0.0 : static_cast<double>(correct) / count; }
};

NearestNeighbourResult NearestNeighbour(const Dataset& dataset, const Split& split);

}  // namespace mocurate
