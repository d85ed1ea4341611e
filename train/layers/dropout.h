#pragma once

#include <torch/torch.h>

#include "train/layers/draws.h"

namespace mocurate {

/// Zeroes numbers of one shard of a training step, each with chance `rate`, and scales the others by 1/(1 - rate).
/// The mask is keyed by seed, step, shard and the position of the call: the same whatever ran before.
class Dropout {
 public:
  /// Without dropout.
  Dropout() = default;
  Dropout(const Draws& draws, double rate) : draws_(&draws), rate_(rate) {}

  bool active() const { return draws_ != nullptr && rate_ > 0.0; }
  torch::Tensor operator()(const torch::Tensor& x);
  /// The mask of a call alone, where it is active: (count) uint8, 1 for what stays and is multiplied by `scale`.
  torch::Tensor Kept(std::int64_t count, double& scale);

 private:
  const Draws* draws_ = nullptr;
  double rate_ = 0.0;
  int calls_ = 0;
};

}  // namespace mocurate
