#include "train/layers/attention.h"

#include <algorithm>
#include <cmath>

#include "train/layers/attention_function.h"

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

Tensor AttentionImpl::Weighted(const Tensor& query, const Tensor& key, const Tensor& value) {
  const std::int64_t T = query.size(0), B = query.size(1), d = width_ / heads_;
  const Tensor scores =
      torch::bmm(OfHeads(query) * (1.0 / std::sqrt(static_cast<double>(d))), OfHeads(key).transpose(1, 2));  // (BH,T,S)
  const Tensor context = torch::bmm(torch::softmax(scores, 2), OfHeads(value));                              // (BH,T,d)
  return out_proj->forward(context.transpose(0, 1).reshape({T, B, width_}));
}

Tensor AttentionImpl::ToItself(const Tensor& x, const Tensor& padded, bool causal, Dropout& dropout) {
  const std::int64_t T = x.size(0), B = x.size(1);
  AttentionRules rules;
  rules.heads = heads_;
  rules.causal = causal;
  rules.hidden = padded;
  if (dropout.active()) rules.kept = dropout.Kept(B * heads_ * T * T, rules.scale);
  return out_proj->forward(Attend({Project(x, 0, 3), Tensor()}, rules));
}

AttentionImpl::Seen AttentionImpl::Remember(const Tensor& memory) const {
  const Tensor projected = Project(memory, 1, 2);  // (S,B,2E)
  return {projected.slice(2, 0, width_), projected.slice(2, width_)};
}

Tensor AttentionImpl::Read(const Tensor& x, const Seen& seen) {
  return Weighted(Project(x, 0, 1), seen.key, seen.value);
}

Tensor AttentionImpl::To(const Tensor& memory, const Tensor& x, const Tensor& padded, Dropout& dropout) {
  if (memory.size(0) > 1) {
    AttentionRules rules;
    rules.heads = heads_;
    rules.hidden = padded;
    if (dropout.active()) {
      rules.kept = dropout.Kept(x.size(1) * heads_ * x.size(0) * memory.size(0), rules.scale);
    }
    return out_proj->forward(Attend({Project(x, 0, 1), Project(memory, 1, 2)}, rules));
  }
  const std::int64_t T = x.size(0), B = x.size(1), d = width_ / heads_;
  const Tensor value = Project(memory[0], 2, 1);  // (B,E)
  const Tensor kept = dropout(torch::ones({B, T, heads_}, x.options()));
  // Each head's part of the output, then their sum at each frame.
  const Tensor of_head = torch::bmm(value.view({B, heads_, d}).transpose(0, 1),
                                    out_proj->weight.view({width_, heads_, d}).permute({1, 2, 0}));  // (H,B,E)
  return torch::bmm(kept, of_head.transpose(0, 1)).transpose(0, 1) + out_proj->bias;                 // (T,B,E)
}

/// Sum over the copies of each entry that are kept, (B,H,T,S), over their number.
Tensor AttentionImpl::ShareOfCopies(const Tensor& count, std::int64_t frames, Dropout& dropout) const {
  const std::int64_t B = count.size(0), S = count.size(1);
  const Tensor of_entry = count.to(torch::kCPU, torch::kInt64).contiguous();
  const auto copies = of_entry.sum(1).max().item<std::int64_t>();
  double scale = 1.0;
  const Tensor kept = dropout.Kept(B * heads_ * frames * copies, scale);
  const Tensor share = torch::empty({B, heads_, frames, S});
  const std::uint8_t* copy = kept.data_ptr<std::uint8_t>();
  float* to = share.data_ptr<float>();
  for (std::int64_t b = 0; b < B; ++b) {
    const std::int64_t* of_motion = of_entry.data_ptr<std::int64_t>() + b * S;
    for (std::int64_t row = 0; row < heads_ * frames; ++row, copy += copies) {
      const std::uint8_t* next = copy;
      for (std::int64_t s = 0; s < S; ++s) {
        int sum = 0;
        for (std::int64_t k = 0; k < of_motion[s]; ++k) sum += *next++;
        *to++ = static_cast<float>(sum * scale / static_cast<double>(std::max<std::int64_t>(1, of_motion[s])));
      }
    }
  }
  return share.to(count.device());
}

Tensor AttentionImpl::ToRepeated(const RepeatedMemory& memory, const Tensor& x, Dropout& dropout) {
  AttentionRules rules;
  rules.heads = heads_;
  rules.bias = torch::log(memory.count);
  if (dropout.active()) rules.share = ShareOfCopies(memory.count, x.size(0), dropout);
  return out_proj->forward(Attend({Project(x, 0, 1), Project(memory.entries, 1, 2)}, rules));
}

Tensor AttentionImpl::Next(const Tensor& x, Seen& seen) {
  const Tensor projected = Project(x, 0, 3);
  const auto append = [](Tensor& all, const Tensor& next) { all = all.defined() ? torch::cat({all, next}) : next; };
  append(seen.key, projected.slice(2, width_, 2 * width_));
  append(seen.value, projected.slice(2, 2 * width_));
  return Weighted(projected.slice(2, 0, width_), seen.key, seen.value);
}

}  // namespace mocurate
