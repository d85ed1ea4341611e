#pragma once

#include <algorithm>
#include <vector>

#include "train/recognisers/recogniser.h"

namespace mocurate {

/// Output for `count` motions (count, frames, dim). `lengths` (count), if given: the output after that many frames
/// counts, else the last.
inline Expected<RecogniserOutput> RunOn(const Recogniser& recogniser, const std::vector<float>& motions, int count,
                                        int frames, int dim, const RecogniserHidden& hidden = {},
                                        const std::vector<int>& lengths = {}, int threads = 1) {
  const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(frames) * dim;
  const auto copy = [&](int begin, int end, float* values, int* read_out) {
    std::copy(motions.begin() + begin * size, motions.begin() + end * size, values);
    for (int n = begin; n < end; ++n) {
      read_out[n - begin] = lengths.empty() ? frames : lengths[static_cast<std::size_t>(n)];
    }
  };
  return recogniser.Run(copy, count, frames, dim, hidden, threads);
}

/// Class with the largest logit.
inline int Predicted(const RecogniserOutput& output, int index) {
  const auto row = output.logits.begin() + static_cast<std::ptrdiff_t>(index) * output.classes;
  return static_cast<int>(std::max_element(row, row + output.classes) - row);
}

}  // namespace mocurate
