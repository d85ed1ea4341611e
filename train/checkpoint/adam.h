#pragma once

#include "train/checkpoint/parameters.h"

namespace mocurate {

struct AdamOptions {
  double learning_rate = 1e-3;
  double beta1 = 0.9;
  double beta2 = 0.999;
  double epsilon = 1e-8;
  double weight_decay = 0.0;  ///< L2: added to the gradient, not decoupled
};

/// Scales all gradients so that their common norm is at most `largest` (> 0).
void ClipGradients(double largest, ParameterList& parameters);

/// Adam as PyTorch computes it (Kingma and Ba 2015, with bias correction). Moments lie beside the parameters, in their
/// order, so that a checkpoint holds them.
struct Adam {
  std::int64_t steps = 0;
  std::vector<std::vector<float>> first;   ///< running mean of the gradient
  std::vector<std::vector<float>> second;  ///< running mean of its square

  /// One step on every parameter from its gradient.
  void Step(const AdamOptions& options, ParameterList& parameters);
};

}  // namespace mocurate
