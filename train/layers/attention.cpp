#include "train/layers/attention.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "train/layers/keep_mask.h"

namespace mocurate {
namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

/// Sizes, and where the rows of a head lie.
struct HeadRows {
  HeadRows(const Tensor& queries, const Tensor& memory, std::int64_t heads_) : heads(heads_) {
    const bool own = !memory.defined();
    T = queries.size(0), B = queries.size(1), S = own ? T : memory.size(0);
    E = own ? queries.size(2) / 3 : queries.size(2), d = E / heads;
    of_query = static_cast<int>(B * queries.size(2));
    of_memory = own ? of_query : static_cast<int>(B * memory.size(2));
    first_key = own ? E : 0;
    query_width = queries.size(2), memory_width = own ? query_width : memory.size(2);
  }
  std::int64_t QueryAt(std::int64_t b, std::int64_t h) const { return b * query_width + h * d; }
  std::int64_t KeyAt(std::int64_t b, std::int64_t h) const { return b * memory_width + first_key + h * d; }
  std::int64_t ValueAt(std::int64_t b, std::int64_t h) const { return KeyAt(b, h) + E; }
  std::int64_t ContextAt(std::int64_t b, std::int64_t h) const { return b * E + h * d; }
  std::int64_t WeightAt(std::int64_t b, std::int64_t h) const { return (b * heads + h) * T * S; }
  int of_context() const { return static_cast<int>(B * E); }
  float root() const { return static_cast<float>(1.0 / std::sqrt(static_cast<double>(d))); }

  std::int64_t T = 0, B = 0, S = 0, E = 0, heads = 1, d = 0;
  int of_query = 0, of_memory = 0;  ///< numbers from a frame to the next
  std::int64_t first_key = 0, query_width = 0, memory_width = 0;
};

/// c (rows, columns) = scale op(a) op(b), row by row; a row of a, b, c has lda, ldb, ldc numbers.
void HeadProduct(bool a_transposed, bool b_transposed, std::int64_t rows, std::int64_t columns, std::int64_t depth,
                 float scale, const float* a, int lda, const float* b, int ldb, float* c, int ldc) {
  cblas_sgemm(CblasRowMajor, a_transposed ? CblasTrans : CblasNoTrans, b_transposed ? CblasTrans : CblasNoTrans,
              static_cast<int>(rows), static_cast<int>(columns), static_cast<int>(depth), scale, a, lda, b, ldb, 0.0f,
              c, ldc);
}

/// Softmax weights times dropout and shares; `weights` itself where there are neither.
Tensor Changed(const Tensor& weights, const Tensor& kept, double scale, const Tensor& share) {
  Tensor result = weights;
  if (kept.defined()) {
    result = torch::empty_like(weights);
    ApplyKept(weights.data_ptr<float>(), kept.data_ptr<std::uint8_t>(), weights.numel(), static_cast<float>(scale),
              result.data_ptr<float>());
  }
  return share.defined() ? result * share : result;
}

struct HeadAttention : torch::autograd::Function<HeadAttention> {
  /// `memory` without numbers: `queries` hold keys and values too.
  static Tensor forward(AutogradContext* context, const Tensor& queries, const Tensor& memory,
                        const AttentionRules& rules) {
    const Tensor q = queries.contiguous(), m = memory.numel() > 0 ? memory.contiguous() : Tensor();
    const HeadRows at(q, m, rules.heads);
    const float* from = q.data_ptr<float>();
    const float* seen = m.defined() ? m.data_ptr<float>() : from;
    Tensor scores = torch::empty({at.B, at.heads, at.T, at.S});
    const Tensor hidden = rules.hidden.defined() ? rules.hidden.contiguous() : Tensor();
    const Tensor bias = rules.bias.defined() ? rules.bias.contiguous() : Tensor();
    const bool* without = hidden.defined() ? hidden.data_ptr<bool>() : nullptr;
    const float* added = bias.defined() ? bias.data_ptr<float>() : nullptr;
    float* all_scores = scores.data_ptr<float>();
    constexpr float kNone = -std::numeric_limits<float>::infinity();
    for (std::int64_t b = 0; b < at.B; ++b) {
      for (std::int64_t h = 0; h < at.heads; ++h) {
        float* of_head = all_scores + at.WeightAt(b, h);
        HeadProduct(false, true, at.T, at.S, at.d, at.root(), from + at.QueryAt(b, h), at.of_query,
                    seen + at.KeyAt(b, h), at.of_memory, of_head, static_cast<int>(at.S));
        for (std::int64_t t = 0; t < at.T; ++t) {
          float* row = of_head + t * at.S;
          for (std::int64_t s = 0; added != nullptr && s < at.S; ++s) row[s] += added[b * at.S + s];
          for (std::int64_t s = 0; without != nullptr && s < at.S; ++s) row[s] = without[b * at.S + s] ? kNone : row[s];
          for (std::int64_t s = t + 1; rules.causal && s < at.S; ++s) row[s] = kNone;
        }
      }
    }
    const Tensor weights = torch::softmax(scores, 3);
    const Tensor changed = Changed(weights, rules.kept, rules.scale, rules.share);
    Tensor result = torch::empty({at.T, at.B, at.E});
    for (std::int64_t b = 0; b < at.B; ++b) {
      for (std::int64_t h = 0; h < at.heads; ++h) {
        HeadProduct(false, false, at.T, at.d, at.S, 1.0f, changed.data_ptr<float>() + at.WeightAt(b, h),
                    static_cast<int>(at.S), seen + at.ValueAt(b, h), at.of_memory,
                    result.data_ptr<float>() + at.ContextAt(b, h), at.of_context());
      }
    }
    context->save_for_backward({q, m, weights, rules.kept, rules.share});
    context->saved_data["heads"] = rules.heads;
    context->saved_data["scale"] = rules.scale;
    return result;
  }

  static variable_list backward(AutogradContext* context, variable_list gradient) {
    const auto saved = context->get_saved_variables();
    const Tensor &q = saved[0], &m = saved[1], &weights = saved[2], &kept = saved[3], &share = saved[4];
    const double scale = context->saved_data["scale"].toDouble();
    const HeadRows at(q, m, context->saved_data["heads"].toInt());
    const Tensor given = gradient[0].contiguous();
    const Tensor changed = Changed(weights, kept, scale, share);
    const Tensor by_queries = torch::empty_like(q), by_memory = m.defined() ? torch::empty_like(m) : Tensor();
    const float* from = q.data_ptr<float>();
    const float* seen = m.defined() ? m.data_ptr<float>() : from;
    float* to = by_queries.data_ptr<float>();
    float* by_seen = m.defined() ? by_memory.data_ptr<float>() : to;
    const int of_weight = static_cast<int>(at.S);
    Tensor by_changed = torch::empty_like(weights);
    for (std::int64_t b = 0; b < at.B; ++b) {
      for (std::int64_t h = 0; h < at.heads; ++h) {
        const float* by_context = given.data_ptr<float>() + at.ContextAt(b, h);
        HeadProduct(false, true, at.T, at.S, at.d, 1.0f, by_context, at.of_context(), seen + at.ValueAt(b, h),
                    at.of_memory, by_changed.data_ptr<float>() + at.WeightAt(b, h), of_weight);
        HeadProduct(true, false, at.S, at.d, at.T, 1.0f, changed.data_ptr<float>() + at.WeightAt(b, h), of_weight,
                    by_context, at.of_context(), by_seen + at.ValueAt(b, h), at.of_memory);
      }
    }
    const Tensor by_weights = Changed(by_changed, kept, scale, share);
    const Tensor by_scores = torch::_softmax_backward_data(by_weights, weights, 3, torch::kFloat32);
    for (std::int64_t b = 0; b < at.B; ++b) {
      for (std::int64_t h = 0; h < at.heads; ++h) {
        const float* of_head = by_scores.data_ptr<float>() + at.WeightAt(b, h);
        HeadProduct(false, false, at.T, at.d, at.S, at.root(), of_head, of_weight, seen + at.KeyAt(b, h), at.of_memory,
                    to + at.QueryAt(b, h), at.of_query);
        HeadProduct(true, false, at.S, at.d, at.T, at.root(), of_head, of_weight, from + at.QueryAt(b, h), at.of_query,
                    by_seen + at.KeyAt(b, h), at.of_memory);
      }
    }
    return {by_queries, by_memory, Tensor()};
  }
};

}  // namespace

Tensor Attend(const AttentionRows& rows, const AttentionRules& rules) {
  if (!rows.queries.device().is_cpu()) return PlainAttend(rows, rules);
  // libtorch 1.13 takes no undefined input.
  return HeadAttention::apply(rows.queries, rows.memory.defined() ? rows.memory : torch::empty({0}), rules);
}

Tensor PlainAttend(const AttentionRows& rows, const AttentionRules& rules) {
  const HeadRows at(rows.queries, rows.memory, rules.heads);
  const Tensor& seen = rows.memory.defined() ? rows.memory : rows.queries;
  const auto of_heads = [&](const Tensor& x, std::int64_t first) {  // (BH, frames, d)
    return x.slice(2, first, first + at.E).reshape({x.size(0), at.B * at.heads, at.d}).transpose(0, 1);
  };
  Tensor scores = torch::bmm(of_heads(rows.queries, 0) * (1.0 / std::sqrt(static_cast<double>(at.d))),
                             of_heads(seen, at.first_key).transpose(1, 2))
                      .view({at.B, at.heads, at.T, at.S});
  const auto of_entry = [&](const Tensor& x) { return x.view({at.B, 1, 1, at.S}); };
  constexpr float kNone = -std::numeric_limits<float>::infinity();
  if (rules.bias.defined()) scores = scores + of_entry(rules.bias);
  if (rules.hidden.defined()) scores = scores.masked_fill(of_entry(rules.hidden), kNone);
  if (rules.causal) {
    const Tensor later = torch::ones({at.T, at.S}, scores.options().dtype(torch::kBool)).triu(1);
    scores = scores.masked_fill(later, kNone);
  }
  Tensor weights = torch::softmax(scores, 3);
  if (rules.kept.defined()) {
    weights = weights * rules.kept.to(weights.device()).view(weights.sizes()) * rules.scale;
  }
  if (rules.share.defined()) weights = weights * rules.share;
  const Tensor context = torch::bmm(weights.view({at.B * at.heads, at.T, at.S}), of_heads(seen, at.first_key + at.E));
  return context.transpose(0, 1).reshape({at.T, at.B, at.E});
}

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
