#pragma once

#include <optional>

#include "train/layers/gru_layer.h"
#include "train/layers/lie_kinematics.h"
#include "train/networks/network.h"

namespace mocurate {

/// Action2Motion (Guo et al. 2020; a2m_actor.md B): a conditional VAE per frame. D = 3 J numbers of a pose, C classes,
/// I = D + C + 1 (without time counter D + C), H = 128, Z = 30. HumanAct12: 117,820 + 117,820 + 227,110 parameters.
///
///   prior, posterior   Linear(I,H) - GRUCell(H,H) - mu Linear(H,Z), logvar Linear(H,Z)
///   decoder            Linear(I + Z,H) - 2 x GRUCell(H,H) - Linear(H,D)
///   with Lie           root: the first 3 numbers; rotations: tanh - Linear(D - 3,D - 3) - pi tanh; joints by
///   kinematics
///
/// A frame reads [pose before | one-hot class | time | z]; no activation follows the first linear layer.
class Action2Motion : public Network {
 public:
  Action2Motion(const Action2MotionOptions& options, const LearningOptions& learning, const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  Motions Answer(const RequestBatch& requests, Draws& draws) override;

 private:
  friend struct NetworkParts;  // of the tests

  /// Prior and posterior.
  struct GaussianNetImpl : torch::nn::Module {
    GaussianNetImpl(std::int64_t input, std::int64_t hidden, std::int64_t latent);
    torch::nn::Linear embed{nullptr}, mu_net{nullptr}, logvar_net{nullptr};
    torch::nn::GRUCell gru{nullptr};
  };
  TORCH_MODULE(GaussianNet);

  struct DecoderImpl : torch::nn::Module {
    DecoderImpl(std::int64_t input, std::int64_t hidden, std::int64_t pose, bool lie);
    torch::nn::Linear embed{nullptr}, output{nullptr}, output_lie{nullptr};
    torch::nn::GRUCell first{nullptr}, second{nullptr};
  };
  TORCH_MODULE(Decoder);

  struct Rollout;

  /// Per number, before any sum: log(s_p/s_q) + (exp(lv_q) + (m_q - m_p)^2) / (2 exp(lv_p)) - 1/2 (B.6).
  static torch::Tensor KlTerms(const torch::Tensor& mean_q, const torch::Tensor& lv_q, const torch::Tensor& mean_p,
                               const torch::Tensor& lv_p);
  torch::Tensor Conditions(const torch::Tensor& label, std::int64_t frames) const;  // (T,B,C [+1])
  torch::Tensor Decode(const torch::Tensor& state);                                 // (...,H) -> (...,D)
  torch::Tensor Joints(const torch::Tensor& output, const torch::Tensor& bone_length) const;
  Rollout Unroll(const Batch& batch, const torch::Tensor& condition, const torch::Tensor& z,
                 const torch::Tensor& bone_length, bool self_feed);

  std::int64_t classes_, pose_, hidden_, latent_;
  TimeChoice time_;
  bool lie_, feed_joints_, mean_loss_;
  double self_feed_, kl_weight_, learning_rate_, weight_decay_;
  LieLayer kinematics_;
  GaussianNet prior_{nullptr}, posterior_{nullptr};
  Decoder decoder_{nullptr};
};

}  // namespace mocurate
