#pragma once

#include <torch/torch.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace mocurate {

/// Random numbers of one shard of one training step, or of requested motions. They are keyed by counter, so
/// that the step is the state of every generator and a motion does not depend on its neighbours.
class Draws {
 public:
  /// Of a training step. Coins are shared by the whole batch, all other draws are the shard's own.
  Draws(std::uint64_t seed, std::int64_t step, int phase, int shard);
  /// Of motions: the draws of motion b depend on seeds[b] only.
  explicit Draws(std::vector<std::uint64_t> seeds);

  /// Replaces the next draws of that purpose: for comparison with other implementations.
  void Give(const std::string& purpose, torch::Tensor values) { given_[purpose] = std::move(values); }

  /// Standard normal, or uniform in [0, 1), of shape (leading, B, width) float32; B motions.
  torch::Tensor Normal(const std::string& purpose, std::int64_t leading, std::int64_t motions, std::int64_t width);
  torch::Tensor Uniform(const std::string& purpose, std::int64_t leading, std::int64_t motions, std::int64_t width);
  /// (B) int64 in [0, classes), each alike.
  torch::Tensor Classes(const std::string& purpose, std::int64_t motions, std::int64_t classes);
  /// Key of a generator of its own.
  std::array<std::uint32_t, 2> Key(const std::string& purpose) const;
  /// True with that probability.
  bool Coin(const std::string& purpose, double probability);

 private:
  std::uint64_t seed_ = 0;
  std::string key_, shard_;
  std::vector<std::uint64_t> motions_;
  std::map<std::string, torch::Tensor> given_;
};

}  // namespace mocurate
