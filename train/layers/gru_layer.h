#pragma once

#include <torch/torch.h>

namespace mocurate {

/// Weights of a GRU layer with PyTorch's gates (r, z, n): (3H,I), (3H,H), (3H), (3H), float32.
struct GruWeights {
  torch::Tensor input, hidden, input_bias, hidden_bias;

  /// Of a cell.
  explicit GruWeights(const torch::nn::GRUCell& cell);
  /// Of layer `layer` of a GRU.
  GruWeights(const torch::nn::GRU& gru, int layer);
  /// Of a cell whose input passes a linear layer first. No activation lies between them (a2m_actor.md B.5), so that
  /// the two products are one: W_ih (E x + e) + b_ih = (W_ih E) x + (W_ih e + b_ih).
  GruWeights(const torch::nn::GRUCell& cell, const torch::nn::Linear& embedding);
};

/// One GRU layer over T frames. `input` (T,B,I), `hidden` (B,H) -> outputs (T,B,H). On the CPU forward and backward are
/// written out: the input products of all frames are one product, elementwise work is fused, weight gradients are one
/// product at the end.
torch::Tensor GruLayer(const torch::Tensor& input, const torch::Tensor& hidden, const GruWeights& weights);

/// The same in plain tensor operations: the reference of GruLayer, and what other devices run.
torch::Tensor PlainGruLayer(const torch::Tensor& input, const torch::Tensor& hidden, const GruWeights& weights);

/// A layer whose input is only known frame by frame. The gradients of its weights are one product over all frames, as
/// in GruLayer, and no longer one a frame.
class GruFrames {
 public:
  /// For exactly `frames` steps of `batch` rows.
  GruFrames(const GruWeights& weights, std::int64_t frames, std::int64_t batch);
  /// `input` (B,I), `hidden` (B,H) -> (B,H).
  torch::Tensor Step(const torch::Tensor& input, const torch::Tensor& hidden);

 private:
  GruWeights weights_;
  torch::Tensor ticket_;          ///< of the node that accumulates the weights' gradients; undefined frame by frame
  torch::Tensor input_, before_;  ///< rows of all frames (T B,I), (T B,H)
  torch::Tensor by_from_input_, by_from_state_;  ///< gradients of their sums (T B,3H)
  std::int64_t row_ = 0;                         ///< where the next frame begins
};

/// One frame: `input` (B,I) -> (B,H).
torch::Tensor GruStep(const torch::Tensor& input, const torch::Tensor& hidden, const GruWeights& weights);

/// All layers of a GRU over T frames. `hidden` (layers,B,H) -> outputs of the last (T,B,H).
torch::Tensor GruStack(const torch::Tensor& input, const torch::Tensor& hidden, const torch::nn::GRU& gru);

}  // namespace mocurate
