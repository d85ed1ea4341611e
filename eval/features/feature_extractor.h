#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "eval/metrics/fid.h"
#include "train/recognisers/recogniser.h"

namespace mocurate {

/// Features (N, 30) and predicted classes of motions, from one pass.
struct Recognised {
  Features features;
  std::vector<int> predicted;
};

/// Prepares each motion as the recogniser was trained (crop starts drawn by `seed` and position) and runs it.
Expected<Recognised> Recognise(const Recogniser& recogniser, const std::vector<const Motion*>& motions,
                               const RecogniserHidden& hidden, std::uint64_t seed);

}  // namespace mocurate
