#include "train/layers/transformer.h"

#include <cmath>
#include <string>

namespace mocurate {

using torch::Tensor;

LayerModules::LayerModules(const TransformerSizes& sizes, bool decodes, double epsilon) {
  const auto norm = torch::nn::LayerNormOptions({sizes.width}).eps(epsilon);
  self_attn = register_module("self_attn", Attention(sizes.width, sizes.heads));
  if (decodes) multihead_attn = register_module("multihead_attn", Attention(sizes.width, sizes.heads));
  linear1 = register_module("linear1", torch::nn::Linear(sizes.width, sizes.feed_forward));
  linear2 = register_module("linear2", torch::nn::Linear(sizes.feed_forward, sizes.width));
  norm1 = register_module("norm1", torch::nn::LayerNorm(norm));
  norm2 = register_module("norm2", torch::nn::LayerNorm(norm));
  if (decodes) norm3 = register_module("norm3", torch::nn::LayerNorm(norm));
}

Tensor TransformerLayerImpl::forward(Tensor x, const Tensor& padded, const Tensor& memory, Dropout& dropout) {
  x = norm1->forward(x + dropout(self_attn->ToItself(x, padded, false, dropout)));
  if (multihead_attn) x = norm2->forward(x + dropout(multihead_attn->To(memory, x, Tensor(), dropout)));
  return (multihead_attn ? norm3 : norm2)->forward(x + Between(x, dropout));
}

Tensor TransformerLayerImpl::Causal(Tensor x, const Tensor& padded, const RepeatedMemory& memory, Dropout& dropout) {
  x = norm1->forward(x + dropout(self_attn->ToItself(x, padded, true, dropout)));
  x = norm2->forward(x + dropout(multihead_attn->ToRepeated(memory, x, dropout)));
  return norm3->forward(x + Between(x, dropout));
}

Tensor TransformerLayerImpl::Between(const Tensor& x, Dropout& dropout) {
  return dropout(linear2->forward(dropout(torch::gelu(linear1->forward(x)))));  // (T,B,F) inside
}

TransformerStackImpl::TransformerStackImpl(const TransformerSizes& sizes, bool decodes) {
  torch::nn::ModuleList list;
  for (std::int64_t i = 0; i < sizes.layers; ++i) {
    layers.emplace_back(sizes, decodes);
    list->push_back(layers.back());
  }
  register_module("layers", list);
  StartAsCopies(layers);
}

Tensor TransformerStackImpl::forward(Tensor x, const Tensor& padded, const Tensor& memory, Dropout& dropout) {
  for (TransformerLayer& layer : layers) x = layer->forward(x, padded, memory, dropout);
  return x;
}

Tensor CausalLayerImpl::Between(const Tensor& x, Dropout& dropout) {
  return x + dropout(linear2->forward(dropout(torch::relu(linear1->forward(norm3->forward(x))))));
}

Tensor CausalLayerImpl::forward(Tensor x, const Tensor& memory, const Tensor& padded, Dropout& dropout) {
  x = x + dropout(self_attn->ToItself(norm1->forward(x), Tensor(), true, dropout));
  x = x + dropout(multihead_attn->To(memory, norm2->forward(x), padded, dropout));
  return Between(x, dropout);
}

Tensor CausalLayerImpl::Next(Tensor x, const AttentionImpl::Seen& memory, AttentionImpl::Seen& seen) {
  Dropout none;
  x = x + self_attn->Next(norm1->forward(x), seen);
  x = x + multihead_attn->Read(norm2->forward(x), memory);
  return Between(x, none);
}

Tensor PositionalTable(std::int64_t count, std::int64_t width) {
  const Tensor position = torch::arange(count, torch::kFloat32).unsqueeze(1);  // (P,1)
  const Tensor rate =
      torch::exp(torch::arange(0, width, 2, torch::kFloat32) * (-std::log(10000.0) / static_cast<double>(width)));
  Tensor table = torch::zeros({count, 1, width});
  table.select(1, 0).slice(1, 0, width, 2).copy_(torch::sin(position * rate));
  table.select(1, 0).slice(1, 1, width, 2).copy_(torch::cos(position * rate));
  return table;
}

}  // namespace mocurate
