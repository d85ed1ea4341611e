#pragma once

#include "train/networks/network.h"

namespace mocurate {

/// Action2Motion's classifier of motions and motion discriminator (a2m_actor.md B.9, D.1). D numbers a frame, H = 128,
/// C outputs.
///
///   GRU(D,H,2) - output of the last frame - Linear(H,30) - tanh (the features) - Linear(30,C) (the logits)
struct GruClassifierImpl : torch::nn::Module {
  struct Heads {
    torch::Tensor features;  // (B,30)
    torch::Tensor logits;    // (B,C)
  };

  GruClassifierImpl(std::int64_t input, std::int64_t hidden, std::int64_t layers, std::int64_t outputs);
  /// `motion` (T,B,D), `hidden` (layers,B,H); `last` (B) int64 is the frame whose output counts, undefined: the last.
  Heads forward(const torch::Tensor& motion, const torch::Tensor& hidden, const torch::Tensor& last = {});

  torch::nn::GRU recurrent{nullptr};
  torch::nn::Linear linear1{nullptr}, linear2{nullptr};
};
TORCH_MODULE(GruClassifier);

/// The classifier as a network that is trained: cross entropy; standardised numbers are folded into the first layer
/// when training ends, so that the stored network reads plain joints.
class GruRecogniser : public Network {
 public:
  GruRecogniser(const GruRecogniserOptions& options, const LearningOptions& learning, const NetworkSizes& sizes);

  std::vector<OptimiserGroup> Groups() override;
  Losses Loss(const Batch& batch, Draws& draws, int phase) override;
  /// A recogniser answers nothing: an empty result.
  Motions Answer(const RequestBatch&, Draws&) override { return {}; }
  ValidationScore Validate(const Batch& batch) override;
  void Standardise(const torch::Tensor& mean, const torch::Tensor& deviation) override;
  void Finish() override;

 private:
  friend struct NetworkParts;  // of the tests

  torch::Tensor Input(const torch::Tensor& motion) const;
  torch::Tensor LastOf(const Batch& batch) const;

  GruRecogniserOptions options_;
  double learning_rate_, weight_decay_;
  torch::Tensor mean_, deviation_;  // (D); undefined: plain joints
  GruClassifier classifier_{nullptr};
};

}  // namespace mocurate
