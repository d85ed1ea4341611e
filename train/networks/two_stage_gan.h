#pragma once

#include "train/networks/network.h"

namespace mocurate {

/// Two-stage GAN (a2m_actor.md B.9), a baseline of Action2Motion's tables. Its network file is not released; sizes and
/// loss are the released ones, layers not marked are choices of ours. D = 3 J, C classes, Z = 30, P = 128, H = 256.
///
///   pose generator    [one-hot C | z ~ U(0,1)^Z] - Linear(.,P) - LeakyReLU - Linear(P,P) - LeakyReLU - Linear(P,D)
///   pose critic       [pose D | one-hot C] - Linear(.,P) - LeakyReLU - Linear(P,P) - LeakyReLU - Linear(P,1)
///   motion generator  state: tanh Linear(C + Z,H) of [one-hot | z_0]; [one-hot | noise N(0,1)^Z] - GRU(.,H) -
///                     sigmoid Linear(H,Z): the latents of the T - 1 frames after z_0, not accumulated
///   motion critic     [pose | one-hot] - GRU(D + C,H) - Linear(H,1) of the last state
///
/// Wasserstein losses, RMSProp; critics' weights clipped, or with `gradient_penalty` w the term w (|gradient| - 1)^2 at
/// a random point between a real and a made input of one class. [Gulrajani et al. 2017, equation 3] The first share of
/// the steps trains poses, the rest motions with the pose generator as it is. Phases: pose critic, pose generator,
/// motion critic, motion generator.
class TwoStageGan : public Network {
 public:
  TwoStageGan(const TwoStageGanOptions& options, const LearningOptions& learning, const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  std::vector<int> Phases(std::int64_t step, std::int64_t steps) const override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  void AfterStep(int phase) override;
  Motions Answer(const RequestBatch& requests, Draws& draws) override;

 private:
  friend struct NetworkParts;  // of the tests

  enum Phase { kPoseCritic, kPoseGenerator, kMotionCritic, kMotionGenerator };

  torch::Tensor Motion(const torch::Tensor& z_0, const torch::Tensor& noise, const torch::Tensor& one_hot);
  torch::Tensor Penalty(const torch::Tensor& real, const torch::Tensor& made, const torch::Tensor& one_hot,
                        Draws& draws);
  void AddPenalty(const torch::Tensor& real, const torch::Tensor& made, const torch::Tensor& one_hot, Draws& draws,
                  double whole, Losses& losses);
  torch::Tensor JudgePoses(const torch::Tensor& poses, const torch::Tensor& one_hot);
  torch::Tensor JudgeMotion(const torch::Tensor& motion, const torch::Tensor& one_hot, bool twice = false);
  Losses PoseLoss(const Batch& batch, Draws& draws, const torch::Tensor& made_of, int phase);

  TwoStageGanOptions options_;
  std::int64_t classes_, pose_;
  double learning_rate_;
  torch::nn::Sequential pose_generator_{nullptr}, pose_critic_{nullptr};
  torch::nn::Linear start_{nullptr}, latent_{nullptr}, judge_{nullptr};
  torch::nn::GRU motion_{nullptr}, judge_motion_{nullptr};
};

}  // namespace mocurate
