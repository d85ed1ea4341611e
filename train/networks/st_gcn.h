#pragma once

#include <torch/torch.h>

#include <vector>

#include "train/networks/network.h"

namespace mocurate {

/// A graph convolution, then one along time (Yan et al. 2018), with the names of the released code. x (B,C,T,V):
///
///   gcn.conv (C -> 3 C') - sum over partitions with A * edge importance - BN - ReLU - Conv(9 frames, stride) - BN
///   + x, or Conv(1, stride) - BN of x, or nothing (first block); ReLU
struct StGcnBlockImpl : torch::nn::Module {
  StGcnBlockImpl(std::int64_t input, std::int64_t output, std::int64_t stride, bool residual);
  torch::Tensor forward(const torch::Tensor& x, const torch::Tensor& adjacency);

  std::int64_t output_;
  bool adds_input_;
  torch::nn::Conv2d conv{nullptr};
  torch::nn::Sequential tcn{nullptr}, residual{nullptr};
};
TORCH_MODULE(StGcnBlock);

/// ACTOR's recogniser of UESTC (a2m_actor.md D.1): rotations of V joints, the first two rows of each matrix. C classes.
///
///   x (B,6,T,V) - BN over 6V channels - 10 blocks: 64 64 64 64 128 128 128 256 256 256 channels, strides 2 at the
///   fifth and eighth - mean over T and V: the features (B,256) - 1x1 Conv (256 -> C): the logits
class StGcn : public Network {
 public:
  StGcn(const StGcnOptions& options, const LearningOptions& learning, const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  /// A recogniser answers nothing: an empty result.
  Motions Answer(const RequestBatch&, Draws&) override { return {}; }
  ValidationScore Validate(const Batch& batch) override;

 private:
  friend struct NetworkParts;  // of the tests

  struct Heads {
    torch::Tensor features;  // (B,256)
    torch::Tensor logits;    // (B,C)
  };
  torch::Tensor InputOf(const Batch& batch) const;
  Heads Run(const torch::Tensor& frames);

  double learning_rate_, weight_decay_;
  bool global_orientation_;
  std::int64_t joints_;
  torch::Tensor partitions_;
  torch::nn::BatchNorm1d data_bn{nullptr};
  std::vector<StGcnBlock> blocks_;
  std::vector<torch::Tensor> edge_importance_;
  torch::nn::Conv2d fcn{nullptr};
};

}  // namespace mocurate
