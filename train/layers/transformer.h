#pragma once

#include <torch/torch.h>

#include <vector>

#include "train/layers/attention.h"

namespace mocurate {

/// Sizes of the layers of a transformer.
struct TransformerSizes {
  std::int64_t width = 256;
  std::int64_t heads = 4;
  std::int64_t feed_forward = 1024;
  std::int64_t layers = 8;
};

/// Modules of a layer with PyTorch's names; `multihead_attn` and `norm3` of decoders alone.
struct LayerModules : torch::nn::Module {
  LayerModules(const TransformerSizes& sizes, bool decodes, double epsilon);

  Attention self_attn{nullptr}, multihead_attn{nullptr};
  torch::nn::Linear linear1{nullptr}, linear2{nullptr};
  torch::nn::LayerNorm norm1{nullptr}, norm2{nullptr}, norm3{nullptr};
};

/// PyTorch's TransformerEncoderLayer and TransformerDecoderLayer, norm after the sum, exact GELU, with their names.
///
///   x = norm1(x + drop(self_attn(x)))
///   decoder: x = norm2(x + drop(multihead_attn(x, memory)))
///   x = norm(x + drop(linear2(drop(gelu(linear1(x))))))
struct TransformerLayerImpl : LayerModules {
  TransformerLayerImpl(const TransformerSizes& sizes, bool decodes) : LayerModules(sizes, decodes, 1e-5) {}
  /// `x` (T,B,E), `padded` (B,T) bool or undefined; `memory` (S,B,E) of decoders.
  torch::Tensor forward(torch::Tensor x, const torch::Tensor& padded, const torch::Tensor& memory, Dropout& dropout);
  /// A decoder's whose frames see themselves and those before them, and repeated entries as memory.
  torch::Tensor Causal(torch::Tensor x, const torch::Tensor& padded, const RepeatedMemory& memory, Dropout& dropout);

 private:
  torch::Tensor Between(const torch::Tensor& x, Dropout& dropout);
};
TORCH_MODULE(TransformerLayer);

/// Layers one after the other, "layers.0" ...; they start as copies of one (a2m_actor.md C.2).
struct TransformerStackImpl : torch::nn::Module {
  TransformerStackImpl(const TransformerSizes& sizes, bool decodes);
  torch::Tensor forward(torch::Tensor x, const torch::Tensor& padded, const torch::Tensor& memory, Dropout& dropout);
  std::vector<TransformerLayer> layers;
};
TORCH_MODULE(TransformerStack);

/// A layer of JoeyNMT's decoder (a2m_actor.md C.6 a): norm before each part, ReLU between, frames see those before
/// them.
///
///   x = x + drop(self_attn(norm1(x)));  x = x + drop(multihead_attn(norm2(x), memory));
///   x = x + drop(linear2(drop(relu(linear1(norm3(x))))))
struct CausalLayerImpl : LayerModules {
  explicit CausalLayerImpl(const TransformerSizes& sizes) : LayerModules(sizes, true, 1e-6) {}
  /// `padded` (B,T) bool of x and memory alike, or undefined.
  torch::Tensor forward(torch::Tensor x, const torch::Tensor& memory, const torch::Tensor& padded, Dropout& dropout);
  /// One frame more, without dropout. `memory` from multihead_attn->Remember.
  torch::Tensor Next(torch::Tensor x, const AttentionImpl::Seen& memory, AttentionImpl::Seen& seen);

 private:
  torch::Tensor Between(const torch::Tensor& x, Dropout& dropout);
};
TORCH_MODULE(CausalLayer);

/// Sines and cosines of positions 0..count-1 (count,1,E) float32: PE(p, 2i) = sin(p 10000^(-2i/E)), PE(p, 2i+1) = cos.
torch::Tensor PositionalTable(std::int64_t count, std::int64_t width);

/// Overwrites each number of `layers` after the first by the first's.
template <class Layer>
void StartAsCopies(const std::vector<Layer>& layers) {
  const torch::NoGradGuard no_gradient;
  for (const Layer& layer : layers) {
    const auto from = layers.front()->parameters(), to = layer->parameters();
    for (std::size_t i = 0; i < to.size(); ++i) {
      torch::Tensor target = to[i];
      if (!target.is_same(from[i])) target.copy_(from[i]);
    }
  }
}

}  // namespace mocurate
