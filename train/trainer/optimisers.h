#pragma once

#include <torch/torch.h>

#include <memory>
#include <string>
#include <vector>

#include "train/checkpoint/checkpoint.h"
#include "train/networks/network.h"

namespace mocurate {

/// The optimisers of a network, one per group; their state is saved in checkpoints and restored bit for bit.
class Optimisers {
 public:
  explicit Optimisers(Network& network);

  const OptimiserGroup& group(int phase) const { return groups_[static_cast<std::size_t>(phase)]; }
  /// Updates the group of that phase by `gradients`, in the order of its parameters (undefined: no gradient); its rate
  /// is `rate_factor` times its own. `largest_norm` 0: no limit.
  void Step(int phase, const std::vector<torch::Tensor>& gradients, double rate_factor, double largest_norm);

  std::vector<OptimiserState> State() const;
  /// Error kInconsistent where the state is of another network.
  Status Restore(const std::vector<OptimiserState>& state, const std::string& where);

 private:
  std::vector<OptimiserGroup> groups_;
  std::vector<std::vector<std::string>> names_;  ///< of the parameters of each group
  std::vector<std::unique_ptr<torch::optim::Optimizer>> rules_;
};

}  // namespace mocurate
