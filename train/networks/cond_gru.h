#pragma once

#include "train/networks/network.h"

namespace mocurate {

/// Conditioned GRU (a2m_actor.md B.9), a baseline of Action2Motion's tables. D = 3 J, C classes, H = 128.
///
///   class   one-hot C - Linear(C,D)
///   frame   [pose | class], 2 D - GRU(2 D,H), zero state - Linear(H,D): the next pose
///
/// Loss: mean squared error a frame, summed over frames. Each sequence is fed the truth with probability 0.5, as the
/// released code decides for its batches of one. No optimiser is published: Adam as Action2Motion's.
class CondGru : public Network {
 public:
  CondGru(const CondGruOptions& options, const LearningOptions& learning, const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  /// A rollout from the first pose (zeros where none is given), or as the published rows were scored (F4).
  Motions Answer(const RequestBatch& requests, Draws& draws) override;

 private:
  friend struct NetworkParts;  // of the tests

  std::int64_t classes_, pose_, hidden_;
  double teacher_forcing_, learning_rate_, weight_decay_;
  bool zeros_;
  torch::nn::Linear linear_c2e_{nullptr}, linear_output_{nullptr};
  torch::nn::GRU gru_{nullptr};
};

}  // namespace mocurate
