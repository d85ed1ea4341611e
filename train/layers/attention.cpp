#include "train/layers/attention.h"

#include <cmath>
#include <limits>

namespace mocurate {

using torch::Tensor;

AttentionImpl::AttentionImpl(std::int64_t width, std::int64_t heads) : width_(width), heads_(heads) {
  in_proj_weight = register_parameter("in_proj_weight", torch::empty({3 * width, width}));
  in_proj_bias = register_parameter("in_proj_bias", torch::zeros({3 * width}));
  out_proj = register_module("out_proj", torch::nn::Linear(width, width));
  torch::nn::init::xavier_uniform_(in_proj_weight);
  torch::nn::init::zeros_(out_proj->bias);
}

Tensor AttentionImpl::Project(const Tensor& x, std::int64_t part, std::int64_t count) const {
  const std::int64_t begin = part * width_, end = (part + count) * width_;
  return torch::linear(x, in_proj_weight.slice(0, begin, end), in_proj_bias.slice(0, begin, end));
}

/// (T,B,E) -> (BH,T,d)
Tensor AttentionImpl::OfHeads(const Tensor& x) const {
  return x.reshape({x.size(0), x.size(1) * heads_, width_ / heads_}).transpose(0, 1);
}

/// `hidden`: bool of a shape that broadcasts to (B,H,T,S); those get no weight.
Tensor AttentionImpl::Weighted(const Tensor& query, const Tensor& key, const Tensor& value, const Tensor& hidden,
                               Dropout& dropout) {
  const std::int64_t T = query.size(0), S = key.size(0), B = query.size(1), d = width_ / heads_;
  Tensor scores =
      torch::bmm(OfHeads(query) * (1.0 / std::sqrt(static_cast<double>(d))), OfHeads(key).transpose(1, 2));  // (BH,T,S)
  if (hidden.defined()) {
    scores = scores.view({B, heads_, T, S})
                 .masked_fill(hidden, -std::numeric_limits<float>::infinity())
                 .view({B * heads_, T, S});
  }
  const Tensor weights = dropout(torch::softmax(scores, 2));
  const Tensor context = torch::bmm(weights, OfHeads(value));  // (BH,T,d)
  return out_proj->forward(context.transpose(0, 1).reshape({T, B, width_}));
}

Tensor AttentionImpl::ToItself(const Tensor& x, const Tensor& padded, bool causal, Dropout& dropout) {
  const std::int64_t T = x.size(0);
  const Tensor projected = Project(x, 0, 3);  // (T,B,3E)
  Tensor hidden;
  if (padded.defined()) hidden = padded.view({padded.size(0), 1, 1, T});
  if (causal) {
    const Tensor later = torch::ones({T, T}, x.options().dtype(torch::kBool)).triu(1).view({1, 1, T, T});
    hidden = hidden.defined() ? hidden.logical_or(later) : later;
  }
  return Weighted(projected.slice(2, 0, width_), projected.slice(2, width_, 2 * width_), projected.slice(2, 2 * width_),
                  hidden, dropout);
}

AttentionImpl::Seen AttentionImpl::Remember(const Tensor& memory) const {
  const Tensor projected = Project(memory, 1, 2);  // (S,B,2E)
  return {projected.slice(2, 0, width_), projected.slice(2, width_)};
}

Tensor AttentionImpl::Read(const Tensor& x, const Seen& seen) {
  Dropout none;
  return Weighted(Project(x, 0, 1), seen.key, seen.value, Tensor(), none);
}

Tensor AttentionImpl::To(const Tensor& memory, const Tensor& x, const Tensor& padded, Dropout& dropout) {
  if (memory.size(0) > 1) {
    const Seen seen = Remember(memory);
    const Tensor hidden = padded.defined() ? padded.view({padded.size(0), 1, 1, memory.size(0)}) : Tensor();
    return Weighted(Project(x, 0, 1), seen.key, seen.value, hidden, dropout);
  }
  const std::int64_t T = x.size(0), B = x.size(1), d = width_ / heads_;
  const Tensor value = Project(memory[0], 2, 1);  // (B,E)
  const Tensor kept = dropout(torch::ones({B, T, heads_}, x.options()));
  // Each head's part of the output, then their sum at each frame.
  const Tensor of_head = torch::bmm(value.view({B, heads_, d}).transpose(0, 1),
                                    out_proj->weight.view({width_, heads_, d}).permute({1, 2, 0}));  // (H,B,E)
  return torch::bmm(kept, of_head.transpose(0, 1)).transpose(0, 1) + out_proj->bias;                 // (T,B,E)
}

Tensor AttentionImpl::ToRepeated(const RepeatedMemory& memory, const Tensor& x, Dropout& dropout) {
  const std::int64_t T = x.size(0), B = x.size(1), S = memory.entries.size(0), d = width_ / heads_;
  const Seen seen = Remember(memory.entries);
  const Tensor scores = torch::bmm(OfHeads(Project(x, 0, 1)) * (1.0 / std::sqrt(static_cast<double>(d))),
                                   OfHeads(seen.key).transpose(1, 2));  // (BH,T,S)
  Tensor weights =
      torch::softmax(scores.view({B, heads_, T, S}) + torch::log(memory.count).view({B, 1, 1, S}), 3);  // (B,H,T,S)
  if (dropout.active()) {
    const Tensor end = memory.count.cumsum(1), begin = end - memory.count;  // (B,S)
    const auto copies = static_cast<std::int64_t>(end.max().item<float>());
    const Tensor copy = torch::arange(copies, memory.count.options()).view({1, copies, 1});
    const Tensor of_entry = (copy >= begin.unsqueeze(1)) * (copy < end.unsqueeze(1));  // (B,copies,S)
    const Tensor kept = dropout(torch::ones({B, heads_ * T, copies}, x.options()));
    const Tensor share = torch::bmm(kept, of_entry / memory.count.clamp_min(1).unsqueeze(1));  // of each entry's copies
    weights = weights * share.view({B, heads_, T, S});
  }
  const Tensor context = torch::bmm(weights.reshape({B * heads_, T, S}), OfHeads(seen.value));  // (BH,T,d)
  return out_proj->forward(context.transpose(0, 1).reshape({T, B, width_}));
}

Tensor AttentionImpl::Next(const Tensor& x, Seen& seen) {
  const Tensor projected = Project(x, 0, 3);
  const auto append = [](Tensor& all, const Tensor& next) { all = all.defined() ? torch::cat({all, next}) : next; };
  append(seen.key, projected.slice(2, width_, 2 * width_));
  append(seen.value, projected.slice(2, 2 * width_));
  Dropout none;
  return Weighted(projected.slice(2, 0, width_), seen.key, seen.value, Tensor(), none);
}

}  // namespace mocurate
